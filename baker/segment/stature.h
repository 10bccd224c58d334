// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/import/import.h"
#include "baker/roles/roles.h"

namespace spherechain::baker {

// The way up in the file's scene. A biped that lies there stands as its rig does: along the axis of the file that is
// next to the way from its pelvis to its head. Where the scene turns the skeleton by any angle, the way is that from
// its ankles to its head.
Vec3 way_up(const Character& character, const Roles& roles);

// How far a biped's crown is above its soles as it stands: from the lowest skin of its legs to the highest skin of its
// head and all of the skin that hangs on it (hair, ears). Other skin does not count: arms and weapons held up, wings, a
// cape on the ground, a rigid hat. Where no skin is a leg's or the head's, all skin counts.
double stature(const Character& character, const Roles& roles);

}  // namespace spherechain::baker
