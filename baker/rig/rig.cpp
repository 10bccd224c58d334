// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/rig/rig.h"

#include <algorithm>

#include "baker/mesh/surface_query.h"

namespace spherechain::baker {

std::vector<VertexWeights> rig_weights(const Character& character, const std::vector<Joint>& joints) {
  const std::vector<VertexWeights> body = bone_heat_weights(character.body, joints);
  const SurfaceQuery surface(character.body);
  std::vector<VertexWeights> weights;
  weights.reserve(character.source_positions.size());
  for (std::size_t v = 0; v < character.source_positions.size(); ++v) {
    Index near = character.body_of_source[v];
    if (near == kNoIndex) {
      const Vec3& p = character.source_positions[v];
      const Triangle& corners = character.body.triangles[surface.closest(p).triangle];
      near = *std::min_element(corners.begin(), corners.end(), [&](Index a, Index b) {
        return (character.body.positions[a] - p).squaredNorm() < (character.body.positions[b] - p).squaredNorm();
      });
    }
    weights.push_back(body[near]);
  }
  return weights;
}

}  // namespace spherechain::baker
