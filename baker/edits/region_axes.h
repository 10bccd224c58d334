// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "baker/edits/edits.h"
#include "baker/segment/body_plan.h"

namespace spherechain::baker {

// A region's own coordinates. They follow from its skin at rest alone, so spheres may change and they stay: they turn,
// move and scale with the mesh, and finer triangles do not change them.
struct RegionAxes {
  Vec3 start;                  // where `along` is 0, in the middle of the skin across
  Vec3 axis;                   // unit; the way the skin is longest, of a round region the character's up
  std::array<Vec3, 2> across;  // unit; the first is the character's forward, or up, as near as it gets
  double length;               // of the skin along the axis

  Vec3 point(const SpherePlace& place) const;
};

// Computes the axes of `count` regions. `of_skin` holds the region of each triangle of the skin, which is in its rest
// pose. An axis points away from the middle of all skin.
std::vector<RegionAxes> region_axes(const BodyFrame& frame, const Mesh& skin, const std::vector<std::uint8_t>& of_skin,
                                    std::size_t count);

}  // namespace spherechain::baker
