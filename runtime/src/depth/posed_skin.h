// SPDX-License-Identifier: MIT
// The skin in a pose, and at rest, triangle by triangle.
#pragma once

#include "pose/pose.h"
#include "skin/double3.h"
#include "skin/skin_table.h"

namespace spherechain {

struct Corners {
  Double3 p[3];
};

// Twice its area long.
inline Double3 normal_of(const Corners& t) { return cross(t.p[1] - t.p[0], t.p[2] - t.p[0]); }

// A triangle is known by its place in Surface::triangles.
struct PosedSkin {
  const Surface* surface = nullptr;
  float* positions = nullptr;  // x, y, z of each of the surface's vertices

  float *low[3] = {}, *high[3] = {};  // of a cluster's box
  double handedness = 1;              // -1: the pose mirrors the skin, and its triangles turn the other way

  void take(WordMemory& memory, std::size_t vertex_count, std::size_t cluster_count);
  // Where the pose's vertices are, or where its bones put them.
  void fill(const Pose& pose, Target resolved);

  Corners corners(std::uint32_t triangle) const { return corners_in(positions, triangle); }
  Corners rest_corners(std::uint32_t triangle) const { return corners_in(surface->rest_positions.data, triangle); }
  std::uint32_t piece(std::uint32_t triangle) const {
    return surface->pieces[surface->triangle_vertices[3 * std::size_t{triangle}]];
  }

 private:
  double find_handedness() const;
  Corners corners_in(const float* all, std::uint32_t triangle) const {
    const std::uint32_t* const v = surface->triangle_vertices.data + 3 * std::size_t{triangle};
    Corners out;
    for (std::size_t i = 0; i < 3; ++i) {
      const float* const p = all + 3 * std::size_t{v[i]};
      out.p[i] = {double{p[0]}, double{p[1]}, double{p[2]}};
    }
    return out;
  }
};

}  // namespace spherechain
