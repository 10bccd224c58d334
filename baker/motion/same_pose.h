// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/motion/motion.h"
#include "baker/segment/body_plan.h"

namespace spherechain::baker {

// True if two poses are equal except for the character's place, which its first bone gives.
bool same_pose(const Deformation& first, const Deformation& last, const BodyFrame& axes);

}  // namespace spherechain::baker
