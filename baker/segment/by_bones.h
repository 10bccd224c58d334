// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "roles/roles.h"
#include "segment/segment.h"

namespace spherechain::baker {

// Segments any body: each triangle belongs to the bone that moves it most, or, where nothing moves it, to a piece of
// its own. A part too small for its share of `spheres` joins the nearest part above it in the rig. The body becomes all
// of the skin. `roles` are those of the rig and tell sides; they may be empty.
Regions segment_by_bones(Character& character, const Roles& roles, std::size_t spheres);

}  // namespace spherechain::baker
