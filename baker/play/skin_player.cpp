// SPDX-License-Identifier: GPL-3.0-or-later
#include "play/skin_player.h"

#include <algorithm>

#include "play/play.h"

namespace spherechain::baker {

BonePose::BonePose(const OpenAsset& asset, const Deformation& deformation)
    : bones_(bone_palette(asset, deformation)), morphs_(deformation.morphs.begin(), deformation.morphs.end()) {
  morphs_.resize(asset->morph_count());
}

sc_pose BonePose::pose() const {
  sc_pose pose;
  pose.bones = bones_.data();
  pose.bone_count = bones_.size() / 12;
  pose.bone_layout = SC_ROWS_3X4;
  pose.morph_weights = morphs_.empty() ? nullptr : morphs_.data();
  pose.morph_weight_count = morphs_.size();
  return pose;
}

bool moved_by_bones(const OpenAsset& asset, const Deformation& deformation) {
  return asset->bone_count() > 0 && deformation.positions.empty();
}

sc_pose pose_of(const std::vector<float>& vertices) {
  sc_pose pose;
  pose.vertices = vertices.data();
  pose.vertex_count = vertices.size() / 3;
  return pose;
}

SkinPose::SkinPose(const AnimatedAsset& animated, const Deformation& deformation) {
  if (moved_by_bones(animated.asset(), deformation)) {
    bones_.emplace(animated.asset(), deformation);
  } else {
    vertices_ = pack(animated.positions(deformation));
  }
}

SkinPlayer::SkinPlayer(const OpenAsset& asset, Target target)
    : asset_(asset), target_(target), scratch_(sc_skin_scratch_words(asset.handle())) {}

SkinContactJob SkinPlayer::job(const sc_pose& pose) {
  SkinContactJob job;
  job.asset = asset_.handle();
  job.pose = pose;
  job.target = target_;
  job.skin_table = asset_.skin_table();
  job.scratch = scratch_.data();
  job.scratch_words = scratch_.size();
  return job;
}

void SkinPlayer::ask(const sc_pose& pose) { check_runtime(job(pose).run()); }

const std::vector<TriangleContact>& SkinPlayer::find(const sc_pose& pose) {
  SkinContactJob job = this->job(pose);
  list_triangles(job, contacts_);
  part_count_ = job.part_count;
  return contacts_;
}

PenetrationJob SkinPlayer::measure_job(const sc_pose& pose, const std::vector<TriangleContact>& contacts) {
  PenetrationJob job;
  job.asset = asset_.handle();
  job.pose = pose;
  job.target = target_;
  job.skin_table = asset_.skin_table();
  job.contacts = contacts.data();
  job.contact_count = contacts.size();
  measure_scratch_.resize(std::max(measure_scratch_.size(), sc_penetration_scratch_words(job.asset, contacts.size())));
  job.scratch = measure_scratch_.data();
  job.scratch_words = measure_scratch_.size();
  return job;
}

const std::vector<Penetration>& SkinPlayer::run(PenetrationJob& job) {
  penetrations_.resize(part_count_);
  job.penetrations = penetrations_.data();
  job.penetration_capacity = penetrations_.size();
  check_runtime(job.run());
  penetrations_.resize(job.penetration_count);
  return penetrations_;
}

const std::vector<Penetration>& SkinPlayer::measure(const sc_pose& pose, bool is_next) {
  std::swap(penetrations_, before_);
  PenetrationJob job = measure_job(pose, contacts_);
  job.previous = is_next ? before_.data() : nullptr;
  job.previous_count = is_next ? before_.size() : 0;
  return run(job);
}

const std::vector<Penetration>& SkinPlayer::measure_quickly(const sc_pose& pose,
                                                            const std::vector<TriangleContact>& contacts) {
  PenetrationJob job = measure_job(pose, contacts);
  job.quick = 1;
  return run(job);
}

Penetration SkinPlayer::measure_parts(const sc_pose& pose, const std::vector<TriangleContact>& contacts) {
  PenetrationJob job = measure_job(pose, contacts);
  Penetration out{};
  job.penetrations = &out;
  job.penetration_capacity = 1;
  check_runtime(job.run());
  return out;
}

}  // namespace spherechain::baker
