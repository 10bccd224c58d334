// SPDX-License-Identifier: MIT
#include "depth/posed_skin.h"

#include <algorithm>
#include <cfloat>

#include "skin/skin_inputs.h"

namespace spherechain {

void PosedSkin::take(WordMemory& memory, std::size_t vertex_count, std::size_t cluster_count) {
  memory.take(positions, 3 * vertex_count);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    memory.take(low[axis], cluster_count);
    memory.take(high[axis], cluster_count);
  }
}

void PosedSkin::fill(const Pose& pose, Target resolved) {
  if (pose.vertices == nullptr) {
    skin_vertices(*surface, pose, resolved, positions);
  } else {
    const std::size_t stride = vertex_stride(pose);
    for (std::size_t v = 0; v < surface->source_vertices.size; ++v) {
      const float* const p = vertex_at(pose.vertices, surface->source_vertices[v], stride);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        positions[3 * v + axis] = p[axis];
      }
    }
  }
  for (std::size_t c = 0; c < surface->clusters.size; ++c) {
    const Cluster& cluster = surface->clusters[c];
    float lows[3] = {FLT_MAX, FLT_MAX, FLT_MAX}, highs[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    for (std::size_t i = 0; i < cluster.vertex_count; ++i) {
      const float* const p = positions + 3 * std::size_t{surface->cluster_vertices[cluster.first_vertex + i]};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        lows[axis] = std::min(lows[axis], p[axis]);
        highs[axis] = std::max(highs[axis], p[axis]);
      }
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis][c] = lows[axis];
      high[axis][c] = highs[axis];
    }
  }
}

}  // namespace spherechain
