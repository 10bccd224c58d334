// SPDX-License-Identifier: MIT
#include "depth/posed_skin.h"

#include "skin/skin_inputs.h"

namespace spherechain {

void PosedSkin::fill(const Pose& pose, Target resolved) {
  if (pose.vertices == nullptr) {
    skin_vertices(*surface, pose, resolved, positions);
    return;
  }
  const std::size_t stride = vertex_stride(pose);
  for (std::size_t v = 0; v < surface->source_vertices.size; ++v) {
    const float* const p = vertex_at(pose.vertices, surface->source_vertices[v], stride);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      positions[3 * v + axis] = p[axis];
    }
  }
}

}  // namespace spherechain
