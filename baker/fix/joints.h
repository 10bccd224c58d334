// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/fix/turned_clip.h"
#include "baker/roles/roles.h"

namespace spherechain::baker {

// The joints that may turn in a clip: those with known roles, or, on a body without such roles, all except the joint
// that carries all others. Elbows and knees turn about their hinge, which is derived from the clip.
std::vector<TurningJoint> turning_joints(const SourceRig& rig, const Roles& roles, const Clip& clip);

// Joints with this role, on either side. Example: "ankle".
std::vector<Index> joints_of_role(const std::vector<TurningJoint>& joints, const Roles& roles, const std::string& role);

}  // namespace spherechain::baker
