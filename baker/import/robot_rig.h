// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

enum class RigJointKind : std::uint8_t { kHinge, kSlide, kBall, kFree };

// A joint of a robot. It moves `node` in its parent, after the node's joints before it.
struct RigJoint {
  std::string name;
  RigJointKind kind = RigJointKind::kHinge;
  Index node = 0;
  Vec3 axis = Vec3::UnitX(), anchor = Vec3::Zero();  // in the node's space at rest; a hinge turns about the anchor
  double zero = 0;                                   // the value at rest: radians or metres
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
  int mimic = -1;  // the joint that this one follows: its value times `multiplier`, plus `offset`
  double multiplier = 1, offset = 0;
};

// The geometry that a simulator or a planner tests in place of a link's mesh, in the space of the rest positions.
struct RigCollider {
  Index bone = 0;
  bool is_convex = false;
  Mesh mesh;
};

// The part of a robot's description that a skeleton of nodes does not hold; without joints for other characters.
struct RobotRig {
  bool is_robot = false;
  std::string name;            // of the robot
  std::vector<Index> bone_of;  // of each node: the bone that moves its geometry; kNoIndex where it has none
  Index root = 0;              // the node that a motion moves through the world
  std::vector<Eigen::AffineCompact3d> base;    // of each node: its place in its parent where all its joints are at rest
  std::vector<RigJoint> joints;                // parents first, as the file lists them
  std::vector<std::array<Index, 2>> excluded;  // bones, first < second: neighbours, or the file excludes the pair
  std::vector<RigCollider> colliders;
};

}  // namespace spherechain::baker
