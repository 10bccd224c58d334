// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "baker/export/formats.h"

// Common parts of the robotics formats: names, masses, joints, and balls in place of solids that a format lacks. World:
// metres, +Z up, the character looks along +X (to_z_up).
namespace spherechain::baker {

// In a body's frame; the inertia is that around the centre.
struct SolidMass {
  double kilograms = 0;
  Vec3 center = Vec3::Zero();
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
};

// Each body as water: the union of its volumes, less what it shares with others at rest. A body without volumes gets a
// thousandth of the character's mass, for engines refuse a moving body without one.
std::vector<SolidMass> masses_of(const Colliders& colliders);

// Balls that stand for a volume. The surface of a cone's balls is off the cone's by at most a fortieth of its radius
// there; a tip of less than a twentieth of the larger radius stays bare. The balls of an ellipsoid or a box go beyond
// its surface by at most an eighth of its smallest radius; the edges of a box, and the ends of long ellipsoids, stay
// bare.
std::vector<BallVolume> balls_of(const Volume& volume);

// The colliders with balls in place of the volumes that `stays` does not accept. A note of what the exchange costs goes
// into `notes`.
Colliders with_balls(const Colliders& colliders, bool (*stays)(const Volume&), std::vector<std::string>& notes);

// Identifiers of the bodies, each once.
std::vector<std::string> link_names(const Colliders& colliders);

// The robot's name, made of the name of the character's file.
std::string robot_name(const Colliders& colliders);

// A joint of one axis. Ball joints become three of these with links without volumes between them, and what hangs on
// nothing hangs on kBaseLink by six. A body that slides in its parent has six, too.
struct RobotJoint {
  std::string name, parent, child;
  bool slides = false;  // prismatic; otherwise revolute
  double reach = 0;     // from -reach to reach, metres or radians
  Vec3 axis;
  Eigen::Isometry3d origin = Eigen::Isometry3d::Identity();  // the child's frame in that of the parent, at 0
};
inline constexpr const char* kBaseLink = "base_link";
std::vector<RobotJoint> robot_joints(const Colliders& colliders);

// Writes URDF. The colliders may hold balls and boxes only.
std::string urdf_of(const Colliders& colliders);

std::string xml_number(double value);
std::string xml_numbers(const Vec3& v);

}  // namespace spherechain::baker
