// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/import/import.h"

namespace spherechain::baker {

// The limbs, "arms" and "legs", that a biped's rig has and no clip raises: the upper arm to the horizontal, the thigh
// by 60 degrees, seen from the trunk.
std::vector<std::string> limbs_never_raised(const Character& character, const std::vector<Clip>& clips);

}  // namespace spherechain::baker
