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

// Triangles joined through shared vertices: a label a triangle, 0 the component of the lowest triangle, and so on.
struct Components {
  std::vector<Index> of_triangle;
  Index count = 0;
};
Components connected_components(const Mesh& mesh);

// Edges that do not have exactly two triangles, one in each direction. 0 means closed and consistently oriented.
std::size_t count_open_edges(const Mesh& mesh);

// The centroid of the surface, each triangle weighted by its area.
Vec3 surface_centroid(const Mesh& mesh);
double surface_area(const Mesh& mesh);

// The least value that, with all below it, has this share of the weights: of (value, weight) in any order. The largest
// where rounding keeps the sum below the share; 0 where there are none.
double weighted_quantile(std::vector<std::pair<double, double>> weighted, double share);

// A size that no rotation or vertex order changes: twice the largest distance from the surface's centroid.
double diameter(const Mesh& mesh);

}  // namespace spherechain::baker
