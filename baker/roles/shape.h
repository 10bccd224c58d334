// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/roles/names.h"
#include "baker/roles/skeleton.h"

namespace spherechain::baker {

// The reason of these hints.
inline constexpr const char* kByShape = "the rig's shape";

// Hints for a rig whose names say nothing. Limbs are long chains that leave the rig's plane of symmetry in pairs. Of
// two pairs, the legs are the pair that points away from the other one, or on four legs the pair nearer to the root.
// There are no hints without such a plane or pairs. The hints do not tell left from right.
std::vector<Hint> hints_from_shape(const Skeleton& skeleton);

}  // namespace spherechain::baker
