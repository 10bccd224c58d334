// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/import/source_rig.h"

namespace spherechain::baker {

// Where each node of a rig is at rest: as its first bone binds it, or else as it hangs on its parent.
std::vector<Affine> places_at_rest(const SourceRig& rig);

// Where each node of a rig turns, at rest, as far as the skin says it: in the middle of the skin that a joint and the
// joint above share. `positions`: the rest positions that rig.weights belong to.
// Empty where the bind pose says it, as in nearly all files. Some exporters bind all joints at one place, often with
// the identity, and their clips move joints so that they seem to turn elsewhere. Where the file itself says that joints
// turn about pivots, these are where they are bound.
std::vector<Vec3> pivots_of(const SourceRig& rig, const std::vector<Vec3>& positions);

}  // namespace spherechain::baker
