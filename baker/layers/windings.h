// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "runtime/src/skin/skin_table.h"

namespace spherechain::baker {

// How often the skin winds around points at rest, as counted along x, y and z: three numbers a point.
struct Windings {
  std::vector<std::int8_t> of_spheres;        // around their centres
  std::vector<std::uint32_t> core_triangles;  // of kCorePoints a part: 1 more than the triangle's place, 0 where no
                                              // skin encloses the point
  std::vector<std::int8_t> of_cores;
};

// Marks the triangles of pieces that are inside out, and those for which others count: in surface.layers.
void find_facings(const Surface& surface);

// `surface` knows its facings. Empty parts have no core points.
Windings find_windings(const AssetView& asset, const Surface& surface);

}  // namespace spherechain::baker
