// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "import/source_rig.h"
#include "rig/rig.h"

namespace spherechain::baker {

// The joints of a file's skeleton that a body has too, named by their roles.
struct RoleJoints {
  std::vector<Joint> joints;
  std::vector<Index> node;           // of each joint
  std::vector<Index> joint_of_node;  // what each node moves with: its own joint or that of the nearest node above it;
                                     // the first joint where there is none

  int find(const std::string& role) const;  // the first joint of that role, -1 none
};

// `roles` and `positions` of every node. Roles beyond those of a body's joints (fingers, twists, hair) get no joint.
// A bone ends at the joint that comes next in a body; a wrist's, an ankle's and a head's at the farthest node they
// move.
RoleJoints joints_by_role(const std::vector<Node>& nodes, const std::vector<std::string>& roles,
                          const std::vector<Vec3>& positions);

// The same for joints that are named by role already.
RoleJoints joints_by_role(std::vector<Joint> joints);

}  // namespace spherechain::baker
