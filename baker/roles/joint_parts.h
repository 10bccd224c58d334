// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/roles/names.h"
#include "baker/roles/skeleton.h"

namespace spherechain::baker {

// Takes nodes that belong to a joint out of the skeleton, so that no way along a limb or the trunk counts a joint
// twice:
// - a node that moves no skin and leads to one joint alone: "LeftArm_offset" above "LeftArm", "null_3" in the place of
//   "joint_4". The joint then hangs on the next joint above.
// - a leaf in its joint's place that takes a share of its skin: a twist, whatever its name.
// A node stays where its name says another part of the body, or a role file names it. Sets `joint`, and measures again.
void join_joint_parts(Skeleton& skeleton, const std::vector<Hint>& hints);

}  // namespace spherechain::baker
