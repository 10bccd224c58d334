// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/euler.h"

#include <cmath>
#include <numbers>

namespace spherechain::baker {
namespace {

constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

Eigen::Quaterniond about(int axis, double degrees) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees / kDegreesPerRadian, Eigen::Vector3d::Unit(axis)));
}

// The same angle, as near to another as whole turns bring it.
double wound(double degrees, double near) { return degrees + 360 * std::round((near - degrees) / 360); }

// The two outer angles, where the innermost is known.
Eigen::Vector3d outer_angles(const Eigen::Quaterniond& rotation, const EulerAxes& axes, double innermost) {
  const auto [outer, middle, inner] = axes;
  const double sign = (outer + 1) % 3 == middle ? 1 : -1;
  Eigen::Matrix3d rest = (rotation * about(inner, -innermost)).toRotationMatrix();
  Eigen::Vector3d out(0, 0, innermost);
  out[0] = std::atan2(sign * rest(inner, middle), rest(middle, middle)) * kDegreesPerRadian;
  rest = about(outer, -out[0]).toRotationMatrix() * rest;
  out[1] = std::atan2(sign * rest(outer, inner), rest(inner, inner)) * kDegreesPerRadian;
  return out;
}

}  // namespace

Eigen::Quaterniond rotation_by(const EulerAxes& axes, const Eigen::Vector3d& degrees) {
  return about(axes[0], degrees[0]) * about(axes[1], degrees[1]) * about(axes[2], degrees[2]);
}

Eigen::Vector3d angles_near(const Eigen::Quaterniond& rotation, const EulerAxes& axes, const Eigen::Vector3d& near) {
  Eigen::Vector3d one = rotation.toRotationMatrix().eulerAngles(axes[0], axes[1], axes[2]) * kDegreesPerRadian;
  // Where the outermost and the innermost axis coincide, one of their angles is free.
  constexpr double kLocked = 1e-5;
  if (std::abs(std::cos(one[1] / kDegreesPerRadian)) < kLocked) one = outer_angles(rotation, axes, near[2]);
  Eigen::Vector3d best = one;
  double least = HUGE_VAL;
  for (Eigen::Vector3d angles : {one, Eigen::Vector3d(one[0] + 180, 180 - one[1], one[2] + 180)}) {
    for (Eigen::Index k = 0; k < 3; ++k) angles[k] = wound(angles[k], near[k]);
    if (const double apart = (angles - near).norm(); apart < least) {
      least = apart;
      best = angles;
    }
  }
  return best;
}

}  // namespace spherechain::baker
