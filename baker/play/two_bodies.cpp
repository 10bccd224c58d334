// SPDX-License-Identifier: GPL-3.0-or-later
#include "play/two_bodies.h"

#include <algorithm>

#include "play/skin_player.h"

namespace spherechain::baker {

TwoBodies::TwoBodies(const OpenAsset& a, const OpenAsset& b, Target target)
    : a_(a), b_(b), target_(target), scratch_(sc_body_scratch_words(a.handle(), b.handle())) {}

template <typename Job>
Job TwoBodies::job(const sc_pose& a, const sc_pose& b) {
  Job job;
  job.a.asset = a_.handle();
  job.a.pose = a;
  job.a.skin_table = a_.skin_table();
  job.b.asset = b_.handle();
  job.b.pose = b;
  job.b.skin_table = b_.skin_table();
  job.target = target_;
  job.scratch = scratch_.data();
  job.scratch_words = scratch_.size();
  return job;
}

const std::vector<TriangleContact>& TwoBodies::find(const sc_pose& a, const sc_pose& b) {
  auto job = this->job<BodyContactJob>(a, b);
  list_triangles(job, contacts_);
  part_count_ = job.part_count;
  return contacts_;
}

const std::vector<Penetration>& TwoBodies::measure(const sc_pose& a, const sc_pose& b, bool is_next) {
  std::swap(penetrations_, before_);
  const std::size_t words = sc_body_penetration_scratch_words(a_.handle(), b_.handle(), contacts_.size());
  scratch_.resize(std::max(scratch_.size(), words));
  auto job = this->job<BodyPenetrationJob>(a, b);
  job.contacts = contacts_.data();
  job.contact_count = contacts_.size();
  job.previous = is_next ? before_.data() : nullptr;
  job.previous_count = is_next ? before_.size() : 0;
  penetrations_.resize(part_count_);
  job.penetrations = penetrations_.data();
  job.penetration_capacity = penetrations_.size();
  check_runtime(job.run());
  return penetrations_;
}

}  // namespace spherechain::baker
