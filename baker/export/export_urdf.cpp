// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "baker/export/robot.h"

namespace spherechain::baker {
namespace {

// Roll, pitch, yaw as URDF takes them: turned around the fixed axes X, Y, Z in this order.
Vec3 roll_pitch_yaw(const Eigen::Matrix3d& r) {
  const double flat = std::hypot(r(0, 0), r(1, 0));
  const double pitch = std::atan2(-r(2, 0), flat);
  if (flat < 1e-9) return {0, pitch, std::atan2(-r(0, 1), r(1, 1))};
  return {std::atan2(r(2, 1), r(2, 2)), pitch, std::atan2(r(1, 0), r(0, 0))};
}

std::string urdf_origin(const Eigen::Isometry3d& at) {
  return fmt::format("<origin xyz=\"{}\" rpy=\"{}\"/>", xml_numbers(at.translation()),
                     xml_numbers(roll_pitch_yaw(at.linear())));
}

std::string urdf_inertial(const SolidMass& mass) {
  const Eigen::Matrix3d& i = mass.inertia;
  return fmt::format(
      "    <inertial><origin xyz=\"{}\"/><mass value=\"{}\"/><inertia ixx=\"{}\" iyy=\"{}\" izz=\"{}\" ixy=\"{}\" "
      "ixz=\"{}\" "
      "iyz=\"{}\"/></inertial>\n",
      xml_numbers(mass.center), xml_number(mass.kilograms), xml_number(i(0, 0)), xml_number(i(1, 1)),
      xml_number(i(2, 2)), xml_number(i(0, 1)), xml_number(i(0, 2)), xml_number(i(1, 2)));
}

std::string urdf_collision(const Volume& volume) {
  if (const auto* box = std::get_if<BoxVolume>(&volume)) {
    Eigen::Isometry3d at(box->rotation);
    at.translation() = box->center;
    return fmt::format("    <collision>{}<geometry><box size=\"{}\"/></geometry></collision>\n", urdf_origin(at),
                       xml_numbers(2 * box->half));
  }
  const auto& ball = std::get<BallVolume>(volume);
  return fmt::format("    <collision><origin xyz=\"{}\"/><geometry><sphere radius=\"{}\"/></geometry></collision>\n",
                     xml_numbers(ball.center), xml_number(ball.radius));
}

const char* srdf_reason(IgnoredReason reason) {
  switch (reason) {
    case IgnoredReason::kAdjacent:
      return "Adjacent";
    case IgnoredReason::kAlways:
      return "Always";
    case IgnoredReason::kNever:
      return "Never";
    default:
      return "Default";  // MoveIt's word for what collides in the default pose
  }
}

// The meaning of the URDF's links: MoveIt reads it beside the URDF and wants the same robot's name in both.
std::string srdf_of(const Colliders& colliders) {
  const std::vector<std::string> names = link_names(colliders);
  std::string group, state, spheres, disabled;
  for (const RobotJoint& joint : robot_joints(colliders)) {
    group += fmt::format("    <joint name=\"{}\"/>\n", joint.name);
    state += fmt::format("    <joint name=\"{}\" value=\"0\"/>\n", joint.name);
  }
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string of_link;
    for (const Volume& volume : colliders.bodies[i].volumes) {
      for (const BallVolume& ball : balls_of(volume)) {
        of_link += fmt::format("    <sphere center=\"{}\" radius=\"{}\"/>\n", xml_numbers(ball.center),
                               xml_number(ball.radius));
      }
    }
    if (of_link.empty()) continue;
    spheres +=
        fmt::format("  <link_sphere_approximation link=\"{}\">\n{}  </link_sphere_approximation>\n", names[i], of_link);
  }
  for (const IgnoredBodies& pair : colliders.ignored) {
    disabled += fmt::format("  <disable_collisions link1=\"{}\" link2=\"{}\" reason=\"{}\"/>\n",
                            names[static_cast<std::size_t>(pair.a)], names[static_cast<std::size_t>(pair.b)],
                            srdf_reason(pair.reason));
  }
  return fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<robot name=\"{}\">\n"
      "  <!-- Written by spherechain beside the URDF of the same name. -->\n"
      "  <group name=\"whole_body\">\n{}  </group>\n"
      "  <group_state name=\"rest\" group=\"whole_body\">\n{}  </group_state>\n"
      "  <virtual_joint name=\"world_joint\" type=\"fixed\" parent_frame=\"world\" child_link=\"{}\"/>\n"
      "{}{}</robot>\n",
      robot_name(colliders), group, state, kBaseLink, spheres, disabled);
}

bool is_of_urdf(const Volume& volume) {
  return std::holds_alternative<BallVolume>(volume) || std::holds_alternative<BoxVolume>(volume);
}

}  // namespace

std::string urdf_of(const Colliders& colliders) {
  const std::vector<std::string> names = link_names(colliders);
  const std::vector<SolidMass> masses = masses_of(colliders);
  double all = 0;
  for (const SolidMass& mass : masses) all += mass.kilograms;
  const double height = std::max(colliders.height, 1e-3), between = all / 1000, radius = height / 50;
  SolidMass dummy;
  dummy.kilograms = between;
  dummy.inertia = 0.4 * between * radius * radius * Eigen::Matrix3d::Identity();
  const std::string damping = xml_number(0.002 * all * height * height * std::sqrt(9.81 / height));

  std::string out = fmt::format(
      "<?xml version=\"1.0\"?>\n"
      "<robot name=\"{}\">\n"
      "  <!-- Written by spherechain. Metres, kilograms; +Z is up, the character looks along +X. A part turns by its "
      "joints\n"
      "       _rx, _ry, _rz in this order; limits, effort and damping are guesses. -->\n"
      "  <link name=\"{}\"/>\n",
      robot_name(colliders), kBaseLink);
  std::size_t body = 0;
  for (const RobotJoint& joint : robot_joints(colliders)) {
    const bool is_body = joint.child == names[body];
    out += fmt::format("  <link name=\"{}\">\n{}", joint.child, urdf_inertial(is_body ? masses[body] : dummy));
    if (is_body) {
      for (const Volume& volume : colliders.bodies[body].volumes) out += urdf_collision(volume);
      ++body;
    }
    out += fmt::format(
        "  </link>\n"
        "  <joint name=\"{}\" type=\"{}\">\n"
        "    <parent link=\"{}\"/><child link=\"{}\"/>{}<axis xyz=\"{}\"/>\n"
        "    <limit lower=\"{}\" upper=\"{}\" effort=\"1000\" velocity=\"20\"/><dynamics damping=\"{}\"/>\n"
        "  </joint>\n",
        joint.name, joint.slides ? "prismatic" : "revolute", joint.parent, joint.child, urdf_origin(joint.origin),
        xml_numbers(joint.axis), xml_number(-joint.reach), xml_number(joint.reach), joint.slides ? "0" : damping);
  }
  return out + "</robot>\n";
}

Export export_urdf(const Colliders& given) {
  Export made;
  const Colliders colliders = with_balls(given, is_of_urdf, made.notes);
  made.files = {{"", urdf_of(colliders)}, {".srdf", srdf_of(colliders)}};
  return made;
}

}  // namespace spherechain::baker
