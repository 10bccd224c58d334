// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "baker/export/robot.h"

// MuJoCo's XML. A body a part, in the frame of the one that it hangs on; quaternions w x y z.
namespace spherechain::baker {
namespace {

// Radians that a ball joint turns at most, where no clip turns it as far; how far it turns beyond the clips, else.
constexpr double kRange = 2.6, kBeyondClips = 0.1;

std::string mjcf_quaternion(const Eigen::Quaterniond& q) {
  return fmt::format("{} {} {} {}", xml_number(q.w()), xml_number(q.x()), xml_number(q.y()), xml_number(q.z()));
}

std::string mjcf_geom(const Volume& volume) {
  if (const auto* cone = std::get_if<ConeVolume>(&volume)) {
    return fmt::format("<geom type=\"capsule\" size=\"{}\" fromto=\"{} {}\"/>", xml_number(cone->radius_a),
                       xml_numbers(cone->a), xml_numbers(cone->b));
  }
  if (const auto* ellipsoid = std::get_if<EllipsoidVolume>(&volume)) {
    return fmt::format("<geom type=\"ellipsoid\" size=\"{}\" pos=\"{}\" quat=\"{}\"/>", xml_numbers(ellipsoid->radii),
                       xml_numbers(ellipsoid->center), mjcf_quaternion(ellipsoid->rotation));
  }
  if (const auto* box = std::get_if<BoxVolume>(&volume)) {
    return fmt::format("<geom type=\"box\" size=\"{}\" pos=\"{}\" quat=\"{}\"/>", xml_numbers(box->half),
                       xml_numbers(box->center), mjcf_quaternion(box->rotation));
  }
  const auto& ball = std::get<BallVolume>(volume);
  return fmt::format("<geom type=\"sphere\" size=\"{}\" pos=\"{}\"/>", xml_number(ball.radius),
                     xml_numbers(ball.center));
}

// MuJoCo's capsule has one radius, and some length.
bool is_of_mujoco(const Volume& volume) {
  const auto* cone = std::get_if<ConeVolume>(&volume);
  return cone == nullptr || (cone->radius_a == cone->radius_b && (cone->a - cone->b).norm() > 1e-6 * cone->radius_a);
}

struct MjcfWriter {
  const Colliders& colliders;
  std::vector<std::string> names;
  std::vector<SolidMass> masses;
  std::string spring = {};  // attributes of joints that slide: a spring holds parts together while the figure falls
  std::string out = {};

  void body(std::size_t i, int depth) {
    const ColliderBody& one = colliders.bodies[i];
    Eigen::Isometry3d at = rest_in_parent(colliders, i);
    if (one.parent < 0) at = Eigen::Isometry3d(to_z_up(colliders)) * at;
    const std::string indent(static_cast<std::size_t>(2 * depth), ' ');
    out += fmt::format("{}<body name=\"{}\" pos=\"{}\" quat=\"{}\">\n", indent, names[i], xml_numbers(at.translation()),
                       mjcf_quaternion(Eigen::Quaterniond(at.linear())));
    for (const char axis : std::string(one.parent < 0 || one.slide == 0 ? "" : "xyz")) {
      const int number = axis - 'x';
      out +=
          fmt::format("{}  <joint type=\"slide\" name=\"{}_t{}\" axis=\"{}\" range=\"{} {}\" {}/>\n", indent, names[i],
                      axis, xml_numbers(Vec3::Unit(number)), xml_number(-one.slide), xml_number(one.slide), spring);
    }
    const char* joint = one.parent < 0 ? "<freejoint name=\"" : "<joint type=\"ball\" name=\"";
    const double reach = std::min(one.turn + kBeyondClips, std::numbers::pi);
    const std::string range =
        one.parent >= 0 && reach > kRange ? fmt::format(" range=\"0 {}\"", xml_number(reach)) : "";
    out += fmt::format("{}  {}{}\"{}/>\n", indent, joint, names[i], range);
    const SolidMass& mass = masses[i];
    const Eigen::Matrix3d& inertia = mass.inertia;
    out += fmt::format("{}  <inertial mass=\"{}\" pos=\"{}\" fullinertia=\"{} {}\"/>\n", indent,
                       xml_number(mass.kilograms), xml_numbers(mass.center), xml_numbers(inertia.diagonal()),
                       xml_numbers({inertia(0, 1), inertia(0, 2), inertia(1, 2)}));
    for (const Volume& volume : one.volumes) out += indent + "  " + mjcf_geom(volume) + "\n";
    for (std::size_t child = i + 1; child < colliders.bodies.size(); ++child) {
      if (colliders.bodies[child].parent == static_cast<int>(i)) body(child, depth + 1);
    }
    out += indent + "</body>\n";
  }
};

// Bounding box of the volumes at rest, in the upright world.
Eigen::AlignedBox3d bounds_of(const Colliders& colliders) {
  const Eigen::Isometry3d up(to_z_up(colliders));
  Eigen::AlignedBox3d out;
  for (const ColliderBody& body : colliders.bodies) {
    const Eigen::Isometry3d at = up * body.rest;
    for (const Volume& one : body.volumes) {
      const Volume volume = moved(one, Affine(at));
      for (int axis = 0; axis < 3; ++axis) {
        out.extend(support(volume, Vec3::Unit(axis)));
        out.extend(support(volume, -Vec3::Unit(axis)));
      }
    }
  }
  return out.isEmpty() ? Eigen::AlignedBox3d(Vec3::Zero()) : out;
}

}  // namespace

Export export_mjcf(const Colliders& given) {
  Export made;
  const Colliders colliders = with_balls(given, is_of_mujoco, made.notes);
  MjcfWriter writer{colliders, link_names(colliders), masses_of(colliders)};
  double mass = 0;
  for (const SolidMass& one : writer.masses) mass += one.kilograms;
  const double height = std::max(colliders.height, 1e-3);
  const double inertia = mass * height * height;
  constexpr double kSpringRate = 63;  // radians a second: the whole figure on such a spring swings ten times a second
  writer.spring = fmt::format("stiffness=\"{}\" damping=\"{}\"", xml_number(mass * kSpringRate * kSpringRate),
                              xml_number(2 * mass * kSpringRate));
  const Eigen::AlignedBox3d bounds = bounds_of(colliders);
  const Vec3 above(bounds.center().x(), bounds.center().y(), bounds.max().z() + 2 * height);
  writer.out = fmt::format(
      "<mujoco model=\"{}\">\n"
      "  <!-- Written by spherechain. Metres, kilograms, radians; +Z is up, the character looks along +X. A ball "
      "joint\n"
      "       has the name of its body. Its damping, armature and range are guesses that let the figure fall softly. "
      "-->\n"
      "  <compiler angle=\"radian\"/>\n"
      "  <option integrator=\"implicitfast\"/>\n"
      "  <statistic center=\"{}\" extent=\"{}\"/>\n"
      "  <default>\n"
      "    <joint damping=\"{}\" armature=\"{}\" range=\"0 {}\"/>\n"
      "    <geom rgba=\"0.85 0.65 0.45 1\"/>\n"
      "  </default>\n"
      "  <worldbody>\n"
      "    <light pos=\"{}\" dir=\"0 0 -1\" directional=\"true\"/>\n"
      "    <geom name=\"floor\" type=\"plane\" size=\"0 0 1\" pos=\"0 0 {}\" rgba=\"0.4 0.45 0.5 1\"/>\n",
      robot_name(colliders), xml_numbers(bounds.center()), xml_number(height),
      xml_number(0.002 * inertia * std::sqrt(9.81 / height)), xml_number(2e-5 * inertia), xml_number(kRange),
      xml_numbers(above), xml_number(bounds.min().z()));
  std::size_t roots = 0;
  for (std::size_t i = 0; i < colliders.bodies.size(); ++i) {
    if (colliders.bodies[i].parent >= 0) continue;
    writer.body(i, 2);
    ++roots;
  }
  writer.out += "  </worldbody>\n";
  if (!colliders.ignored.empty()) {
    writer.out += "  <contact>\n";
    for (const IgnoredBodies& pair : colliders.ignored) {
      writer.out +=
          fmt::format("    <exclude body1=\"{}\" body2=\"{}\"/>\n", writer.names[static_cast<std::size_t>(pair.a)],
                      writer.names[static_cast<std::size_t>(pair.b)]);
    }
    writer.out += "  </contact>\n";
  }
  writer.out += "</mujoco>\n";
  if (roots > 1) made.notes.push_back(fmt::format("{} parts hang on no other: each moves freely", roots));
  made.files = {{"", writer.out}};
  return made;
}

}  // namespace spherechain::baker
