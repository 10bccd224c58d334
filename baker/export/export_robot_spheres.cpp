// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>

#include "baker/export/robot.h"

// The two YAML files that planners with collision spheres read, each beside its URDF. Numbers have a point and no
// exponent, and names quotes: YAML 1.1 takes 1e-05 for a text and no for false.
namespace spherechain::baker {
namespace {

constexpr const char* kStem = "@NAME_OF_OUTPUT@";

std::string yaml_number(double value) {
  std::string out = fmt::format("{:.9f}", value);
  while (out.back() == '0' && out[out.size() - 2] != '.') out.pop_back();
  return out == "-0.0" ? "0.0" : out;
}

std::string yaml_list(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "\"" : ", \"") + name + "\"";
  return "[" + out + "]";
}

std::string yaml_repeated(double value, std::size_t count) {
  std::string out;
  for (std::size_t i = 0; i < count; ++i) out += (i == 0 ? "" : ", ") + yaml_number(value);
  return "[" + out + "]";
}

struct SphereRobot {
  Colliders colliders;             // balls only
  std::vector<std::string> names;  // of all bodies
  std::vector<std::string> with_spheres;
  std::vector<std::string> tips;  // with spheres, and nothing hangs on them
  std::vector<std::string> joints;
  Export made;

  explicit SphereRobot(const Colliders& given) {
    colliders = with_balls(
        given, [](const Volume& volume) { return std::holds_alternative<BallVolume>(volume); }, made.notes);
    names = link_names(colliders);
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (colliders.bodies[i].volumes.empty()) continue;
      with_spheres.push_back(names[i]);
      const bool carries = std::any_of(colliders.bodies.begin(), colliders.bodies.end(),
                                       [&](const ColliderBody& body) { return body.parent == static_cast<int>(i); });
      if (!carries) tips.push_back(names[i]);
    }
    if (tips.empty() && !names.empty()) tips.push_back(names.back());
    for (const RobotJoint& joint : robot_joints(colliders)) joints.push_back(joint.name);
  }

  std::string spheres(const std::string& indent) const {
    std::string out;
    for (std::size_t i = 0; i < names.size(); ++i) {
      if (colliders.bodies[i].volumes.empty()) continue;
      out += indent + "\"" + names[i] + "\":\n";
      for (const Volume& volume : colliders.bodies[i].volumes) {
        const auto& ball = std::get<BallVolume>(volume);
        out += fmt::format("{}- {{center: [{}, {}, {}], radius: {}}}\n", indent, yaml_number(ball.center.x()),
                           yaml_number(ball.center.y()), yaml_number(ball.center.z()), yaml_number(ball.radius));
      }
    }
    return out;
  }

  // Each pair once; the readers take it both ways.
  std::string ignored(const std::string& indent) const {
    std::string out;
    for (std::size_t i = 0; i < names.size(); ++i) {
      std::vector<std::string> others;
      for (const IgnoredBodies& pair : colliders.ignored) {
        const auto b = static_cast<std::size_t>(pair.b);
        if (pair.a != static_cast<int>(i) || colliders.bodies[i].volumes.empty()) continue;
        if (!colliders.bodies[b].volumes.empty()) others.push_back(names[b]);
      }
      if (!others.empty()) out += fmt::format("{}\"{}\": {}\n", indent, names[i], yaml_list(others));
    }
    return out.empty() ? indent + "{}\n" : out;
  }

  std::string zeros(const std::vector<std::string>& keys, const std::string& indent) const {
    std::string out;
    for (const std::string& key : keys) out += indent + "\"" + key + "\": 0.0\n";
    return out;
  }

  Export with(const std::string& yaml) && {
    made.files = {{"", yaml}, {".urdf", urdf_of(colliders)}};
    made.stem_mark = kStem;
    return std::move(made);
  }
};

}  // namespace

Export export_xrdf(const Colliders& given) {
  SphereRobot robot(given);
  const std::size_t count = robot.joints.size();
  const std::string yaml = fmt::format(
      "# Written by spherechain; supplements the URDF beside it.\n"
      "format: xrdf\n"
      "format_version: 1.0\n"
      "default_joint_positions:\n{}"
      "cspace:\n"
      "  joint_names: {}\n"
      "  acceleration_limits: {}\n"
      "  jerk_limits: {}\n"
      "tool_frames: {}\n"
      "collision:\n"
      "  geometry: spherechain\n"
      "  buffer_distance:\n{}"
      "self_collision:\n"
      "  geometry: spherechain\n"
      "  buffer_distance:\n{}"
      "  ignore:\n{}"
      "geometry:\n"
      "  spherechain:\n"
      "    spheres:\n{}",
      robot.zeros(robot.joints, "  "), yaml_list(robot.joints), yaml_repeated(15, count), yaml_repeated(500, count),
      yaml_list(robot.tips), robot.zeros(robot.with_spheres, "    "), robot.zeros(robot.with_spheres, "    "),
      robot.ignored("    "), robot.spheres("      "));
  return std::move(robot).with(yaml);
}

Export export_curobo(const Colliders& given) {
  SphereRobot robot(given);
  const std::size_t count = robot.joints.size();
  const std::string yaml = fmt::format(
      "# Written by spherechain; goes with the URDF beside it. cuRobo looks for relative paths in its own folder of "
      "assets.\n"
      "robot_cfg:\n"
      "  kinematics:\n"
      "    urdf_path: \"{}.urdf\"\n"
      "    asset_root_path: \"\"\n"
      "    base_link: {}\n"
      "    ee_link: \"{}\"\n"
      "    link_names: {}\n"
      "    lock_joints: null\n"
      "    extra_links: null\n"
      "    collision_link_names: {}\n"
      "    collision_sphere_buffer: 0.0\n"
      "    collision_spheres:\n{}"
      "    self_collision_ignore:\n{}"
      "    self_collision_buffer:\n{}"
      "    use_global_cumul: true\n"
      "    mesh_link_names: null\n"
      "    cspace:\n"
      "      joint_names: {}\n"
      "      retract_config: {}\n"
      "      null_space_weight: {}\n"
      "      cspace_distance_weight: {}\n"
      "      max_jerk: 500.0\n"
      "      max_acceleration: 15.0\n",
      kStem, kBaseLink, robot.tips.empty() ? kBaseLink : robot.tips.front(), yaml_list(robot.tips),
      yaml_list(robot.with_spheres), robot.spheres("      "), robot.ignored("      "),
      robot.zeros(robot.with_spheres, "      "), yaml_list(robot.joints), yaml_repeated(0, count),
      yaml_repeated(1, count), yaml_repeated(1, count));
  return std::move(robot).with(yaml);
}

}  // namespace spherechain::baker
