// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

using Neighbours = std::vector<std::array<Index, 3>>;  // as triangle_neighbours has them

// Triangles of one label that are connected over edges. Islands are numbered in the order of their lowest triangles.
struct Islands {
  std::vector<Index> of_triangle;
  std::vector<std::vector<Index>> triangles;  // of each island
  std::vector<double> area;
};
Islands find_islands(const Mesh& mesh, const Neighbours& neighbours, const std::vector<std::uint8_t>& labels);

// The length of the border that an island shares with each label.
std::array<double, 256> border_lengths(const Mesh& mesh, const Neighbours& neighbours, const Islands& islands,
                                       const std::vector<std::uint8_t>& labels, Index island);

}  // namespace spherechain::baker
