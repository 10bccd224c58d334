// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fit/bone_weights.h"

#include <algorithm>

namespace spherechain::baker {

BoneWeights mean_weights(const Character& character, const std::vector<Index>& triangles) {
  BoneWeights means;
  if (character.rig.weights.empty()) return means;
  means.reserve(3 * kMaxInfluences);
  double sum = 0;
  for (const Index t : triangles) {
    const double share = triangle_area(character.skin, t) / 3;
    for (const Index corner : character.source_triangles[character.skin_source_triangle[t]]) {
      const VertexWeights& weights = character.rig.weights[corner];
      for (std::size_t k = 0; k < kMaxInfluences; ++k) {
        if (weights.weight[k] > 0) means[weights.joint[k]] += share * weights.weight[k];
      }
      sum += share;
    }
  }
  for (auto& [bone, weight] : means) weight /= sum;
  return means;
}

double overlap(const BoneWeights& a, const BoneWeights& b) {
  double sum = 0;
  for (const auto& [bone, weight] : a) {
    const auto other = b.find(bone);
    if (other != b.end()) sum += std::min(weight, other->second);
  }
  return sum;
}

}  // namespace spherechain::baker
