// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/import/source_rig.h"
#include "baker/rig/rig.h"

namespace spherechain::baker {

// The joints of a file's skeleton that a body has too, named by their roles.
struct RoleJoints {
  std::vector<Joint> joints;
  std::vector<Index> node;           // of each joint
  std::vector<Index> joint_of_node;  // the joint that each node moves with: its own or that of the nearest node above;
                                     // 0 where there is none

  int find(const std::string& role) const;  // the first joint of that role, -1 none
};

// `roles` and `positions` are those of every node. Roles that are no joints of a body (fingers, twists, hair) are left
// out. A bone ends at the next joint of the body; that of a wrist, an ankle or the head at the farthest node it moves.
RoleJoints joints_by_role(const std::vector<Node>& nodes, const std::vector<std::string>& roles,
                          const std::vector<Vec3>& positions);

// The same for joints that are named by role already.
RoleJoints joints_by_role(std::vector<Joint> joints);

}  // namespace spherechain::baker
