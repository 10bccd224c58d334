// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "baker/score/scored_skin.h"
#include "spherechain/contacts.h"

namespace spherechain::baker {

// Intersecting triangles that are far apart along the skin, as PoseShield counts them (ECCV 2026: at least
// 50 steps for poses, 40 for motions): a step goes over an edge to the next triangle, and pieces that do not hang
// together are far. The steps depend on how fine the mesh is; nothing tells how deep the skin goes, and an elbow of a
// fine mesh counts as a hand in a chest does. Pairs that intersect at rest are left out here, as they are everywhere in
// this tool.
class FarPairs {
 public:
  inline static constexpr std::array<int, 2> kSteps{50, 40};

  explicit FarPairs(const ScoredSkin& skin);
  // How many pairs are so many steps apart, for each of kSteps.
  std::array<std::size_t, 2> count(const std::vector<TriangleContact>& contacts);

 private:
  // Walks from a triangle until its steps to all of these are known, or too many.
  void walk(Index from, const std::vector<Index>& to);

  std::vector<std::array<Index, 3>> neighbours_;
  std::unordered_map<std::uint64_t, std::uint8_t> known_;  // by two triangles; kSteps[0]: so many or more
  std::vector<std::uint32_t> walked_in_;                   // by triangle: the last walk that came to it
  std::vector<std::uint8_t> steps_;                        // and its steps there
  std::uint32_t walks_ = 0;
};

}  // namespace spherechain::baker
