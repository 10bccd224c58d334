// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "baker/segment/body_plan.h"

namespace spherechain::baker {

// The plan of a body with any number of limbs, by its shape alone. It finds the plane of symmetry first, then long
// branches in pairs across that plane, and long curves in it:
// - two pairs are arms and legs where the lower pair continues the trunk, else forelegs and hind legs,
// - more pairs are left_leg_1, right_leg_1, ... from the front,
// - a neck or a tail that is long compared with the trunk is a limb,
// - a shape without branches is one tubular limb, "body", without a spine.
//
// `four_legs`: there are two pairs, and neither is arms. `facing`: forward where the body stands upright, else the
// direction from the hind legs to the head. There is no result where branches do not pair or leave no trunk.
Attempt<BodyPlan> find_limbed_plan(const Mesh& mesh, const CurveSkeleton& skeleton, bool four_legs,
                                   const std::optional<Vec3>& facing);

}  // namespace spherechain::baker
