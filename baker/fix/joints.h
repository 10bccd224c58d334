// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "fix/turned_clip.h"
#include "roles/roles.h"

namespace spherechain::baker {

// The joints that may turn in a clip, of all that a body's roles name; of a body without such roles all but the one
// that carries all others. Elbows and knees give way along their hinge, as the clip bends it.
std::vector<TurningJoint> turning_joints(const SourceRig& rig, const Roles& roles, const Clip& clip);

// Joints with this role, on either side. Example: "ankle".
std::vector<Index> joints_of_role(const std::vector<TurningJoint>& joints, const Roles& roles, const std::string& role);

}  // namespace spherechain::baker
