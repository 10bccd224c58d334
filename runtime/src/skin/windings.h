// SPDX-License-Identifier: MIT
// How often the skin winds around the spheres' centres and around core points at rest, and which triangles count for
// it.
#pragma once

#include "runtime/src/skin/skin_table.h"

namespace spherechain {

constexpr std::size_t kShortAxis = 2;  // most characters stand along y, and are thinnest along z

// Memory while the windings are found.
struct PieceSum {
  double middle[3], area, volume;
};
struct WindingScratch {
  Span<std::uint32_t> next;             // a triangle's
  Span<std::uint32_t> first_of_corner;  // a vertex'
  Span<PieceSum> pieces;                // a vertex'
};

// Fills from Surface::facings on, from a table that is filled but for these.
void find_windings(const AssetView& asset, const Surface& surface, const WindingScratch& scratch);

}  // namespace spherechain
