// SPDX-License-Identifier: GPL-3.0-or-later
#include "play/two_bodies.h"

#include <algorithm>

#include "play/skin_player.h"

namespace spherechain::baker {

TwoBodies::TwoBodies(const OpenAsset& a, const OpenAsset& b, Target target)
    : a_(a), b_(b), target_(target), scratch_(sc_body_scratch_words(a.handle(), b.handle())) {}

Body TwoBodies::body(const OpenAsset& asset, const sc_pose& pose) const {
  Body out;
  out.asset = asset.handle();
  out.pose = pose;
  out.skin_table = asset.skin_table();
  return out;
}

const std::vector<TriangleContact>& TwoBodies::find(const sc_pose& a, const sc_pose& b) {
  BodyContactJob job;
  job.a = body(a_, a);
  job.b = body(b_, b);
  job.target = target_;
  job.scratch = scratch_.data();
  job.scratch_words = scratch_.size();
  list_triangles(job, contacts_);
  part_count_ = job.part_count;
  return contacts_;
}

const std::vector<Penetration>& TwoBodies::measure(const sc_pose& a, const sc_pose& b, bool is_next) {
  std::swap(penetrations_, before_);
  const std::size_t words = sc_body_penetration_scratch_words(a_.handle(), b_.handle(), contacts_.size());
  scratch_.resize(std::max(scratch_.size(), words));
  BodyPenetrationJob job;
  job.a = body(a_, a);
  job.b = body(b_, b);
  job.target = target_;
  job.contacts = contacts_.data();
  job.contact_count = contacts_.size();
  job.previous = is_next ? before_.data() : nullptr;
  job.previous_count = is_next ? before_.size() : 0;
  job.scratch = scratch_.data();
  job.scratch_words = scratch_.size();
  penetrations_.resize(part_count_);
  job.penetrations = penetrations_.data();
  job.penetration_capacity = penetrations_.size();
  check_runtime(job.run());
  return penetrations_;
}

}  // namespace spherechain::baker
