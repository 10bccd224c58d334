// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/robot_joints.h"

#include "baker/mesh/error.h"

namespace spherechain::baker {

std::vector<Index> driven_joints(const RobotRig& robot) {
  std::vector<Index> out;
  for (Index j = 0; j < robot.joints.size(); ++j) {
    if (robot.joints[j].kind != RigJointKind::kFree && robot.joints[j].mimic < 0) out.push_back(j);
  }
  return out;
}

Affine moved_by_joints(const RobotRig& robot, Index node, const std::vector<double>& values,
                       const std::vector<Eigen::Quaterniond>& turns) {
  Affine out = robot.base[node];
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const RigJoint& joint = robot.joints[j];
    if (joint.node != node) continue;
    const Eigen::Translation3d there(joint.anchor), back(-joint.anchor);
    const double value = values[j] - joint.zero;
    if (joint.kind == RigJointKind::kSlide)
      out = out * Eigen::Translation3d(value * joint.axis);
    else if (joint.kind == RigJointKind::kHinge)
      out = out * Affine(there * Eigen::AngleAxisd(value, joint.axis) * back);
    else if (joint.kind == RigJointKind::kBall && j < turns.size())
      out = out * Affine(there * turns[j] * back);
  }
  return out;
}

void follow_mimics(const RobotRig& robot, std::vector<double>& values) {
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    double multiplier = 1, offset = 0;
    std::size_t leader = j;
    while (robot.joints[leader].mimic >= 0) {
      const RigJoint& joint = robot.joints[leader];
      offset += multiplier * joint.offset;
      multiplier *= joint.multiplier;
      leader = static_cast<std::size_t>(joint.mimic);
    }
    if (leader != j) values[j] = multiplier * values[leader] + offset;
  }
}

void place_at_rest(SourceRig& rig, const std::string& file) {
  const RobotRig& robot = rig.robot;
  std::vector<double> values;
  for (const RigJoint& joint : robot.joints) {
    values.push_back(joint.zero);
    std::size_t steps = 0;
    for (int j = joint.mimic; j >= 0; j = robot.joints[static_cast<std::size_t>(j)].mimic) {
      if (++steps > robot.joints.size())
        throw Error(ExitCode::kFile, file + ": joint '" + joint.name + "' mimics itself, by way of others");
    }
  }
  follow_mimics(robot, values);
  for (Index n = 0; n < rig.nodes.size(); ++n) {
    rig.nodes[n].local = moved_by_joints(robot, n, values);
    decompose(rig.nodes[n]);
  }
}

}  // namespace spherechain::baker
