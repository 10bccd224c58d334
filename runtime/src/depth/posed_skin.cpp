// SPDX-License-Identifier: MIT
#include "runtime/src/depth/posed_skin.h"

#include <algorithm>
#include <cfloat>

#include "runtime/src/skin/skin_inputs.h"

namespace spherechain {
namespace {

constexpr std::size_t kAsked = 32;  // clusters, for the handedness

}  // namespace

void PosedSkin::take(WordMemory& memory, std::size_t vertex_count, std::size_t cluster_count) {
  memory.take(positions, 3 * vertex_count);
  memory.take(clusters, cluster_count);
  memory.take(is_listed, cluster_count);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    memory.take(low[axis], cluster_count);
    memory.take(high[axis], cluster_count);
    memory.take(group_low[axis], (cluster_count + kGroup - 1) / kGroup);
    memory.take(group_high[axis], (cluster_count + kGroup - 1) / kGroup);
  }
}

void PosedSkin::fill(const Pose& pose, Target resolved) {
  clusters.size = surface->clusters.size;
  for (std::uint32_t c = 0; c < clusters.size; ++c) {
    clusters[c] = c;
  }
  fill_clusters(pose, resolved);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t first = 0; first < surface->clusters.size; first += kGroup) {
      const std::size_t end = std::min(first + kGroup, surface->clusters.size);
      group_low[axis][first / kGroup] = *std::min_element(low[axis] + first, low[axis] + end);
      group_high[axis][first / kGroup] = *std::max_element(high[axis] + first, high[axis] + end);
    }
  }
}

void PosedSkin::fill(const Pose& pose, Target resolved, const std::uint64_t (&parts)[4]) {
  std::fill(is_listed, is_listed + surface->clusters.size, 0);
  clusters.size = 0;
  const auto list = [&](std::uint32_t c) {
    if (is_listed[c] == 0) {
      is_listed[c] = 1;
      clusters[clusters.size++] = c;
    }
  };
  for (std::size_t c = 0; c < surface->clusters.size; c += asked_step()) {
    list(static_cast<std::uint32_t>(c));
  }
  for (std::size_t part = 0; part + 1 < surface->first_of_part.size; ++part) {
    if ((parts[part / 64] >> part % 64 & 1) == 0) {
      continue;
    }
    for (std::size_t i = surface->first_of_part[part]; i < surface->first_of_part[part + 1]; ++i) {
      list(surface->part_runs[i].cluster);
    }
  }
  fill_clusters(pose, resolved);
}

void PosedSkin::fill_clusters(const Pose& pose, Target resolved) {
  if (pose.vertices == nullptr) {
    skin_vertices(*surface, pose, resolved, {clusters.data, clusters.size}, positions);
  }
  const std::size_t stride = vertex_stride(pose);
  for (const std::uint32_t c : clusters) {
    const Cluster& cluster = surface->clusters[c];
    float lows[3] = {FLT_MAX, FLT_MAX, FLT_MAX}, highs[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    for (std::size_t i = 0; i < cluster.vertex_count; ++i) {
      const std::size_t v = surface->cluster_vertices[cluster.first_vertex + i];
      float* const p = positions + 3 * v;
      if (pose.vertices != nullptr) {
        const float* const from = vertex_at(pose.vertices, surface->source_vertices[v], stride);
        std::copy(from, from + 3, p);
      }
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

std::size_t PosedSkin::asked_step() const { return (surface->clusters.size + kAsked - 1) / kAsked; }

// By some clusters, whichever parts stand in the pose: is their vertex that is farthest from a triangle's plane at rest
// on the other side of it now?
double PosedSkin::find_handedness() const {
  int votes = 0;
  for (std::size_t c = 0; c < surface->clusters.size; c += asked_step()) {
    const Cluster& cluster = surface->clusters[c];
    const Corners rest = rest_corners(cluster.first_triangle), posed = corners(cluster.first_triangle);
    const auto above = [](const Corners& t, const float* p) {
      return dot(normal_of(t), Double3{double{p[0]}, double{p[1]}, double{p[2]}} - t.p[0]);
    };
    double most = 0;
    std::size_t farthest = surface->cluster_vertices[cluster.first_vertex];
    for (std::size_t k = 0; k < cluster.vertex_count; ++k) {
      const std::size_t v = surface->cluster_vertices[cluster.first_vertex + k];
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
