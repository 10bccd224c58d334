// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

namespace spherechain::baker {

using Vec3 = Eigen::Vector3d;
using Index = std::uint32_t;
using Triangle = std::array<Index, 3>;

inline constexpr Index kNoIndex = ~Index{0};

// An indexed triangle mesh; counter-clockwise seen from outside.
struct Mesh {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
};

Vec3 triangle_centroid(const Mesh& mesh, std::size_t t);
// Twice the area times the unit normal.
Vec3 triangle_cross(const Mesh& mesh, std::size_t t);
double triangle_area(const Mesh& mesh, std::size_t t);

// For each triangle the neighbour across edge (k, k+1), kNoIndex where the edge is a border or has more than two
// triangles.
std::vector<std::array<Index, 3>> triangle_neighbours(const Mesh& mesh);

// Connected components over shared vertices: a label for each triangle, numbered in the order of their lowest
// triangles.
struct Components {
  std::vector<Index> of_triangle;
  Index count = 0;
};
Components connected_components(const Mesh& mesh);

// Counts the edges that do not have exactly two triangles, one in each direction. 0 means closed and consistently
// oriented.
std::size_t count_open_edges(const Mesh& mesh);

// The centroid of the surface, each triangle weighted by its area.
Vec3 surface_centroid(const Mesh& mesh);
double surface_area(const Mesh& mesh);

// The smallest value such that it and all smaller values have this share of the weights. `weighted`: (value, weight) in
// any order. Returns the largest value where rounding keeps the sum below the share, and 0 without values.
double weighted_quantile(std::vector<std::pair<double, double>> weighted, double share);

// Twice the largest distance from the surface's centroid: a size that does not depend on orientation or vertex order.
double diameter(const Mesh& mesh);

}  // namespace spherechain::baker
