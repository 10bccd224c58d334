// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/motion/motion.h"

namespace spherechain::baker {

std::vector<Vec3> morph(std::vector<Vec3> rest, const std::vector<Morph>& morphs, const std::vector<double>& weights) {
  for (std::size_t m = 0; m < weights.size(); ++m) {
    if (weights[m] == 0) continue;
    for (std::size_t i = 0; i < morphs[m].vertices.size(); ++i) {
      rest[morphs[m].vertices[i]] += weights[m] * morphs[m].deltas[i];
    }
  }
  return rest;
}

std::vector<Vec3> deform(const std::vector<Vec3>& rest, const std::vector<VertexWeights>& weights,
                         const std::vector<Affine>& bones) {
  std::vector<Vec3> positions = rest;
  if (bones.empty()) return positions;
  for (std::size_t v = 0; v < rest.size(); ++v) {
    for (std::size_t k = 0; k < kMaxInfluences && weights[v].weight[k] > 0; ++k) {
      // Displacements, not positions: weights that sum to 1 only to rounding leave rest where it is.
      positions[v] += weights[v].weight[k] * (bones[weights[v].joint[k]] * rest[v] - rest[v]);
    }
  }
  return positions;
}

}  // namespace spherechain::baker
