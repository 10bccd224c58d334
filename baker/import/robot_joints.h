// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/import/source_rig.h"

namespace spherechain::baker {

// Moves the nodes of a robot to its pose at rest: every joint at its zero, and those that mimic another where that puts
// them. Throws Error(kFile) that begins with `file` where joints mimic each other in a circle.
void place_at_rest(SourceRig& rig, const std::string& file);

// The joints that a motion has values of, in the file's order: no free ones, and none that mimics another.
std::vector<Index> driven_joints(const RobotRig& robot);

// The transform of a node in its parent, from its base and the values of all joints (hinges, slides) or turns (balls).
// `values` has one number for each joint.
Affine moved_by_joints(const RobotRig& robot, Index node, const std::vector<double>& values,
                       const std::vector<Eigen::Quaterniond>& turns = {});

// Sets the values of joints that mimic others.
void follow_mimics(const RobotRig& robot, std::vector<double>& values);

}  // namespace spherechain::baker
