// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "roles/names.h"
#include "roles/skeleton.h"

namespace spherechain::baker {

// Hints for a rig whose names say nothing. Limbs are what leaves the rig's plane of symmetry in pairs and is long; of
// two pairs, legs are the one that points away from the other, or on four legs the one nearer to the root. Without such
// a plane or pairs there are no hints. Which side is left stays open.
std::vector<Hint> hints_from_shape(const Skeleton& skeleton);

}  // namespace spherechain::baker
