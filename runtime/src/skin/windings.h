// SPDX-License-Identifier: MIT
// How often the skin winds around the spheres' centres at rest, and which triangles count for it.
#pragma once

#include "runtime/src/skin/skin_table.h"

namespace spherechain {

// Memory while the windings are found.
struct PieceSum {
  double middle[3], area, volume;
};
struct WindingScratch {
  Span<std::uint32_t> next;             // a triangle's
  Span<std::uint32_t> first_of_corner;  // a vertex'
  Span<PieceSum> pieces;                // a vertex'
};

// Fills Surface::facings, rest_windings and sphere_parts, from a table that is filled but for these.
void find_windings(const AssetView& asset, const Surface& surface, const WindingScratch& scratch);

}  // namespace spherechain
