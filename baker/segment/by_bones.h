// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "baker/roles/roles.h"
#include "baker/segment/segment.h"

namespace spherechain::baker {

// Segments any body: each triangle belongs to the bone that moves it most, or, where nothing moves it, to a piece of
// its own. A part too small for its share of `spheres` joins the nearest part above it in the rig. The body becomes all
// of the skin. `roles` are those of the rig and tell sides; they may be empty.
// `facing` overrides which way is forward.
Regions segment_by_bones(const Character& character, const Roles& roles, const std::optional<Vec3>& facing,
                         std::size_t spheres);

// A tree of limbs, and perhaps the torso, of other regions, and of parts by bones in the place of the rest.
struct MixedRegions {
  static constexpr int kNone = -1;

  Regions regions;
  std::vector<int> kept;  // of each region: which of the other regions it was; none: a part by bones
};

// Keeps regions of `found` (one entry each in `kept`, the torso last), and segments the skin of the others as
// segment_by_bones does. There is a torso, and at least one region is not kept.
MixedRegions segment_rest_by_bones(const Character& character, const Regions& found, const std::vector<bool>& kept,
                                   const Roles& roles, std::size_t spheres);

}  // namespace spherechain::baker
