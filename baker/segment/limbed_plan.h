// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "segment/body_plan.h"

namespace spherechain::baker {

// The plan of a body with any number of limbs, by its shape alone: the plane of symmetry first, then the long branches
// as pairs across it and as curves in it. Two pairs are arms and legs where the lower one goes on from the trunk, else
// forelegs and hind legs; more are left_leg_1, right_leg_1, ... from the front. A neck or a tail that is long beside
// the trunk is a limb. A shape without branches is one tubular limb, "body", and has no spine.
//
// `four_legs`: two pairs, and neither is arms. `facing`: forward, for one that stands upright, else the way from the
// hind legs to the head. There is none where the branches do not pair, or leave no trunk.
Attempt<BodyPlan> find_limbed_plan(const Mesh& mesh, const CurveSkeleton& skeleton, bool four_legs,
                                   const std::optional<Vec3>& facing);

}  // namespace spherechain::baker
