// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/rig/rig.h"

#include <algorithm>

#include "baker/mesh/surface_query.h"

namespace spherechain::baker {

std::vector<VertexWeights> rig_weights(const Character& character, const BodyMesh& body,
                                       const std::vector<Joint>& joints) {
  const std::vector<VertexWeights> of_body = bone_heat_weights(body.mesh, joints);
  const SurfaceQuery surface(body.mesh);
  std::vector<VertexWeights> weights;
  weights.reserve(character.source_positions.size());
  for (std::size_t v = 0; v < character.source_positions.size(); ++v) {
    Index near = body.of_source[v];
    if (near == kNoIndex) {
      const Vec3& p = character.source_positions[v];
      const Triangle& corners = body.mesh.triangles[surface.closest(p).triangle];
      near = *std::min_element(corners.begin(), corners.end(), [&](Index a, Index b) {
        return (body.mesh.positions[a] - p).squaredNorm() < (body.mesh.positions[b] - p).squaredNorm();
      });
    }
    weights.push_back(of_body[near]);
  }
  return weights;
}

}  // namespace spherechain::baker
