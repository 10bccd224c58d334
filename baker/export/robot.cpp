// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/export/robot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <numbers>

#include "baker/export/names.h"
#include "baker/export/solid_grid.h"

namespace spherechain::baker {
namespace {

constexpr double kWater = 1000;  // kg per cubic metre

bool is_in_identifier(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

// Volumes that several bodies contain at rest are divided among these bodies.
SolidMass mass_of(const Colliders& colliders, std::size_t body) {
  SolidMass out;
  Vec3 moment = Vec3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  const std::vector<Volume>& volumes = colliders.bodies[body].volumes;
  for_each_solid_cell(volumes, [&](const Vec3& point, const Vec3& cell) {
    if (!inside_any(volumes, point)) return;
    const Vec3 at_rest = colliders.bodies[body].rest * point;
    const auto holders =
        std::count_if(colliders.bodies.begin(), colliders.bodies.end(), [&](const ColliderBody& other) {
          return inside_any(other.volumes, other.rest.inverse(Eigen::Isometry) * at_rest);
        });
    const double mass = kWater * cell.prod() / static_cast<double>(std::max<std::ptrdiff_t>(holders, 1));
    out.kilograms += mass;
    moment += mass * point;
    second += mass * (point * point.transpose());
    second.diagonal() += mass / 12 * cell.cwiseAbs2();
  });
  if (out.kilograms <= 0) return out;
  out.center = moment / out.kilograms;
  second -= out.kilograms * out.center * out.center.transpose();
  out.inertia = second.trace() * Eigen::Matrix3d::Identity() - second;
  return out;
}

}  // namespace

std::vector<SolidMass> masses_of(const Colliders& colliders) {
  std::vector<SolidMass> out;
  double all = 0;
  for (std::size_t i = 0; i < colliders.bodies.size(); ++i) {
    out.push_back(mass_of(colliders, i));
    all += out.back().kilograms;
  }
  for (SolidMass& mass : out) {
    if (mass.kilograms > 0) continue;
    mass.kilograms = std::max(all, 1e-3) / 1000;
    const double radius = std::max(colliders.height, 1e-3) / 50;
    mass.inertia = 0.4 * mass.kilograms * radius * radius * Eigen::Matrix3d::Identity();
  }
  return out;
}

Colliders with_balls(const Colliders& colliders, bool (*stays)(const Volume&), std::vector<std::string>& notes) {
  Colliders out = colliders;
  std::size_t replaced = 0, balls = 0;
  double before = 0, covered = 0, beyond = 0;
  for (ColliderBody& body : out.bodies) {
    std::vector<Volume> old, fresh, kept;
    for (const Volume& volume : body.volumes) {
      if (stays(volume)) {
        kept.push_back(volume);
        continue;
      }
      old.push_back(volume);
      for (const BallVolume& ball : balls_of(volume)) fresh.push_back(ball);
    }
    if (old.empty()) continue;
    replaced += old.size();
    balls += fresh.size();
    std::vector<Volume> both = old;
    both.insert(both.end(), fresh.begin(), fresh.end());
    for_each_solid_cell(both, [&](const Vec3& point, const Vec3& cell) {
      const bool was = inside_any(old, point), is = inside_any(fresh, point);
      before += was ? cell.prod() : 0;
      covered += was && is ? cell.prod() : 0;
      beyond += is && !was ? cell.prod() : 0;
    });
    body.volumes = kept;
    body.volumes.insert(body.volumes.end(), fresh.begin(), fresh.end());
  }
  if (replaced > 0) {
    notes.push_back(fmt::format(
        "{} volumes that the format does not have became {} spheres, which hold {:.1f} % of their volume and "
        "{:.1f} % of it beyond them",
        replaced, balls, 100 * covered / std::max(before, 1e-300), 100 * beyond / std::max(before, 1e-300)));
  }
  return out;
}

std::vector<std::string> link_names(const Colliders& colliders) {
  return unique_names(colliders, is_in_identifier, {kBaseLink});
}

std::string robot_name(const Colliders& colliders) {
  const std::string stem = with_allowed(std::filesystem::path(colliders.source_file).stem().string(), is_in_identifier);
  return stem.empty() ? "character" : stem;
}

std::vector<RobotJoint> robot_joints(const Colliders& colliders) {
  const std::vector<std::string> names = link_names(colliders);
  std::vector<RobotJoint> out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const int parent = colliders.bodies[i].parent;
    std::string last = parent < 0 ? kBaseLink : names[static_cast<std::size_t>(parent)];
    Eigen::Isometry3d origin = rest_in_parent(colliders, i);
    if (parent < 0) origin = Eigen::Isometry3d(to_z_up(colliders)) * origin;
    const double slide = parent < 0 ? 10 * std::max(colliders.height, 1e-3) : colliders.bodies[i].slide;
    const auto add = [&](const char* motion, int axis, bool slides, bool is_last) {
      RobotJoint joint;
      joint.reach = slides ? slide : std::numbers::pi;
      joint.name = names[i] + "_" + motion;
      joint.parent = last;
      joint.child = last = is_last ? names[i] : joint.name + "_link";
      joint.slides = slides;
      joint.axis = Vec3::Unit(axis);
      joint.origin = origin;
      origin.setIdentity();
      out.push_back(std::move(joint));
    };
    if (slide > 0) {
      // It slides along the axes of the world, or of its parent, and turns around its own.
      const Eigen::Isometry3d place = origin;
      origin.linear().setIdentity();
      add("tx", 0, true, false);
      add("ty", 1, true, false);
      add("tz", 2, true, false);
      origin.linear() = place.linear();
    }
    add("rx", 0, false, false);
    add("ry", 1, false, false);
    add("rz", 2, false, true);
  }
  return out;
}

std::string xml_number(double value) { return fmt::format("{:.10g}", value == 0 ? 0.0 : value); }

std::string xml_numbers(const Vec3& v) { return xml_number(v.x()) + " " + xml_number(v.y()) + " " + xml_number(v.z()); }

}  // namespace spherechain::baker
