// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/motion.h"

namespace spherechain::baker {

std::vector<Vec3> deform(const std::vector<Vec3>& rest, const std::vector<VertexWeights>& weights,
                         const Deformation& deformation) {
  std::vector<Vec3> positions = rest;
  for (std::size_t v = 0; v < rest.size(); ++v) {
    for (std::size_t k = 0; k < kMaxInfluences && weights[v].weight[k] > 0; ++k) {
      // Displacements, not positions: weights that sum to 1 only to rounding leave rest where it is.
      positions[v] += weights[v].weight[k] * (deformation.bones[weights[v].joint[k]] * rest[v] - rest[v]);
    }
  }
  return positions;
}

}  // namespace spherechain::baker
