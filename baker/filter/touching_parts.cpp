// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/filter/touching_parts.h"

#include <algorithm>

#include "baker/play/skin_player.h"
#include "runtime/src/contacts/contact_jobs.h"

namespace spherechain::baker {

std::vector<std::vector<std::uint8_t>> parts_of_spheres(const OpenAsset& asset) {
  const BodyParts parts = body_parts_of(asset);
  std::vector<std::vector<std::uint8_t>> out(asset->spheres().size);
  for (std::size_t s = 0; s < out.size(); ++s) {
    for (const std::uint32_t t : asset.triangles_of(s)) out[s].push_back(parts.of_triangle[t]);
    std::sort(out[s].begin(), out[s].end());
    out[s].erase(std::unique(out[s].begin(), out[s].end()), out[s].end());
  }
  return out;
}

PartSkin::PartSkin(const OpenAsset& asset) : table(skin_table_words(asset.handle())) {
  check_runtime(prepare_skin(asset.handle(), table.data(), table.size()));
  Surface surface;
  check_runtime(read_skin_table(asset.view(), table.data(), surface));
  // The runtime leaves out the triangles in this list. No triangle has this number.
  std::fill(surface.rest_contacts.begin(), surface.rest_contacts.end(), Pair{kNoPlace, kNoPlace});

  const std::vector<std::vector<std::uint8_t>> parts = parts_of_spheres(asset);
  for (std::uint32_t a = 0; a < parts.size(); ++a) {
    if (parts[a].size() > 1) pairs.push_back({a, a});
    for (std::uint32_t b = a + 1; b < parts.size(); ++b) {
      const bool has_two = parts[a].size() > 1 || parts[b].size() > 1 || parts[a] != parts[b];
      if (has_two && !parts[a].empty() && !parts[b].empty()) pairs.push_back({a, b});
    }
  }
}

TouchingParts::TouchingParts(const AnimatedAsset& animated, const PartSkin& skin, Target target)
    : animated_(animated), skin_(skin), target_(target), scratch_(skin_scratch_words(animated.asset().handle())) {}

const std::vector<PartContact>& TouchingParts::find(const Deformation& deformation) {
  const OpenAsset& asset = animated_.asset();
  SkinContactJob job;
  const SkinPose skin(animated_, deformation);
  job.pose = skin.pose();
  job.asset = asset.handle();
  job.target = target_;
  job.skin_table = skin_.table.data();
  job.scratch = scratch_.data();
  job.scratch_words = scratch_.size();

  job.candidates = skin_.pairs.data();
  job.candidate_count = skin_.pairs.size();
  const std::size_t parts = asset->part_count();
  contacts_.resize(skin_.pairs.empty() ? 0 : parts * (parts + 1) / 2);
  if (contacts_.empty()) return contacts_;
  job.parts = contacts_.data();
  job.part_capacity = contacts_.size();
  check_runtime(job.run());
  contacts_.resize(job.part_count);
  return contacts_;
}

}  // namespace spherechain::baker
