// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter/touching_parts.h"

#include <algorithm>
#include <optional>

#include "motion/carried_motion.h"
#include "play/skin_player.h"

namespace spherechain::baker {

WholeSkin::WholeSkin(const OpenAsset& asset) : table_(sc_skin_table_words(asset.handle())) {
  check_runtime(sc_prepare_skin(asset.handle(), table_.data(), table_.size()));
  Surface surface;
  check_runtime(read_skin_table(asset.view(), table_.data(), surface));
  // The runtime leaves out the triangles listed here: list none that exist.
  std::fill(surface.rest_contacts.begin(), surface.rest_contacts.end(), Pair{kNoPlace, kNoPlace});
}

TouchingParts::TouchingParts(const AnimatedAsset& animated, const WholeSkin& skin, Target target)
    : animated_(animated), skin_(skin), target_(target), scratch_(sc_skin_scratch_words(animated.asset().handle())) {}

const std::vector<PartContact>& TouchingParts::find(const Deformation& deformation) {
  const OpenAsset& asset = animated_.asset();
  SkinContactJob job;
  std::optional<BonePose> bones;
  std::vector<float> vertices;
  if (moved_by_bones(asset, deformation)) {
    job.pose = bones.emplace(asset, deformation).pose();
  } else {
    vertices = pack(animated_.positions(deformation));
    job.pose.vertices = vertices.data();
    job.pose.vertex_count = vertices.size() / 3;
  }
  job.asset = asset.handle();
  job.scope = SC_SCOPE_ALL;
  job.target = target_;
  job.skin_table = skin_.table();
  job.scratch = scratch_.data();
  job.scratch_words = scratch_.size();
  contacts_.resize(asset->part_count() * (asset->part_count() + 1) / 2);
  job.parts = contacts_.data();
  job.part_capacity = contacts_.size();
  check_runtime(job.run());
  contacts_.resize(job.part_count);
  return contacts_;
}

}  // namespace spherechain::baker
