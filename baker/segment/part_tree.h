// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "baker/import/import.h"

namespace spherechain::baker {

// Triangles of the skin that move as one.
struct Part {
  static constexpr int kNone = -1;

  int node = kNone;  // of the rig; none where nothing moves them
  std::vector<Index> triangles;
  int parent = kNone;  // another part
};

// The node of the rig that moves each triangle of the skin most; none where nothing moves it.
std::vector<int> heaviest_nodes(const Character& character);

// The tree of parts: each triangle belongs to the bone that moves it most, or, where nothing moves it, to a piece of
// its own. A part too small for its share of `spheres` joins the nearest part above it in the rig. The root is the
// last, and its own parent. Triangles in `left_out` (one entry for each of the skin, or none) are in no part; at least
// one is left.
std::vector<Part> build_part_tree(const Character& character, std::size_t spheres, const std::vector<bool>& left_out);

// Where the area of triangles lies: its centroid, and how far it spreads along its principal axes, the longest first.
struct Extent {
  Vec3 centroid = Vec3::Zero();
  std::array<Vec3, 3> axis;
  std::array<double, 3> spread;  // standard deviations
};
Extent extent_of(const Mesh& mesh, const std::vector<Index>& triangles);

double area_of(const Mesh& mesh, const std::vector<Index>& triangles);

// The squared distance of the nearest of their triangles, of some hundred of each.
double distance_of(const Mesh& mesh, const std::vector<Index>& a, const std::vector<Index>& b);

}  // namespace spherechain::baker
