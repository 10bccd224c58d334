// SPDX-License-Identifier: MIT
#include "depth/posed_skin.h"

#include <algorithm>
#include <cfloat>

#include "skin/skin_inputs.h"

namespace spherechain {
namespace {

constexpr std::size_t kAsked = 64;  // clusters, for the handedness

}  // namespace

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
  handedness = find_handedness();
}

// By some clusters: is their vertex that is farthest from a triangle's plane at rest on the other side of it now?
double PosedSkin::find_handedness() const {
  const std::size_t step = (surface->clusters.size + kAsked - 1) / kAsked;
  int votes = 0;
  for (std::size_t c = 0; c < surface->clusters.size; c += step) {
    const Cluster& cluster = surface->clusters[c];
    const Corners rest = rest_corners(cluster.first_triangle), posed = corners(cluster.first_triangle);
    const auto above = [](const Corners& t, const float* p) {
      return dot(normal_of(t), Double3{double{p[0]}, double{p[1]}, double{p[2]}} - t.p[0]);
    };
    double most = 0;
    std::size_t farthest = surface->cluster_vertices[cluster.first_vertex];
    for (std::size_t i = 0; i < cluster.vertex_count; ++i) {
      const std::size_t v = surface->cluster_vertices[cluster.first_vertex + i];
      const double height = above(rest, surface->rest_positions.data + 3 * v);
      if (std::abs(height) > std::abs(most)) {
        most = height;
        farthest = v;
      }
    }
    const double turn = most * above(posed, positions + 3 * farthest);
    votes += turn > 0 ? 1 : turn < 0 ? -1 : 0;
  }
  return votes < 0 ? -1 : 1;
}

}  // namespace spherechain
