// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/export/simple_volumes.h"

#include <algorithm>
#include <cmath>

#include "baker/mesh/even_directions.h"

namespace spherechain::baker {
namespace {

// `of_radius` makes larger volumes of larger radii.
template <typename OfRadius>
Volume of_content(double content, double least, double most, OfRadius of_radius) {
  for (int step = 0; step < 60; ++step) {
    const double middle = (least + most) / 2;
    (volume_of(of_radius(middle)) < content ? least : most) = middle;
  }
  return of_radius((least + most) / 2);
}

// Along the longest of three half axes, from tip to tip.
Volume capsule_along(const Vec3& center, const Eigen::Quaterniond& rotation, const Vec3& half, double content) {
  Eigen::Index longest = 0;
  const double length = half.maxCoeff(&longest);
  const Vec3 axis = rotation * Vec3::Unit(longest);
  return without_inner_ball(of_content(content, 0, length, [&](double radius) -> Volume {
    const Vec3 arm = (length - radius) * axis;
    return ConeVolume{center - arm, center + arm, radius, radius};
  }));
}

// Exactly this volume. An initializer list would make g++ 12 take it for uninitialized outside of unity builds.
SimpleVolumes unchanged(const Volume& volume) {
  SimpleVolumes out;
  out.volumes.push_back(volume);
  return out;
}

}  // namespace

double surface_distance(const Volume& a, const Volume& b) {
  constexpr int kDirections = 400;
  double out = 0;
  for (const Vec3& direction : even_directions(kDirections)) {
    out = std::max(out, std::abs(direction.dot(support(a, direction) - support(b, direction))));
  }
  return out;
}

Volume without_inner_ball(const Volume& volume) {
  const auto* cone = std::get_if<ConeVolume>(&volume);
  if (cone == nullptr || (cone->b - cone->a).norm() > 1.000001 * std::abs(cone->radius_a - cone->radius_b) + 1e-9) {
    return volume;
  }
  return cone->radius_a >= cone->radius_b ? BallVolume{cone->a, cone->radius_a} : BallVolume{cone->b, cone->radius_b};
}

SimpleVolumes as_capsule(const Volume& from) {
  const Volume volume = without_inner_ball(from);
  Volume out = volume;
  if (const auto* cone = std::get_if<ConeVolume>(&volume)) {
    if (cone->radius_a == cone->radius_b) return unchanged(volume);
    const auto [least, most] = std::minmax(cone->radius_a, cone->radius_b);
    out = of_content(volume_of(volume), least, most, [&](double radius) -> Volume {
      return ConeVolume{cone->a, cone->b, radius, radius};
    });
  } else if (const auto* ellipsoid = std::get_if<EllipsoidVolume>(&volume)) {
    out = capsule_along(ellipsoid->center, ellipsoid->rotation, ellipsoid->radii, volume_of(volume));
  } else if (const auto* box = std::get_if<BoxVolume>(&volume)) {
    out = capsule_along(box->center, box->rotation, box->half, volume_of(volume));
  } else {
    return unchanged(volume);
  }
  return {{out}, surface_distance(volume, out)};
}

SimpleVolumes as_balls(const Volume& from) {
  const Volume volume = without_inner_ball(from);
  if (std::holds_alternative<BallVolume>(volume)) return unchanged(volume);
  const auto* cone = std::get_if<ConeVolume>(&volume);
  if (cone == nullptr) {
    const SimpleVolumes capsule = as_capsule(volume);
    SimpleVolumes out = as_balls(capsule.volumes.front());
    out.off += capsule.off;
    return out;
  }
  const double length = (cone->b - cone->a).norm(), radius = std::min(cone->radius_a, cone->radius_b);
  const int steps = std::max(1, static_cast<int>(std::min(32.0, std::ceil(length / radius))));
  SimpleVolumes out;
  for (int i = 0; i <= steps; ++i) {
    const double t = static_cast<double>(i) / steps;
    out.volumes.push_back(
        BallVolume{cone->a + t * (cone->b - cone->a), cone->radius_a + t * (cone->radius_b - cone->radius_a)});
  }
  // The deepest points are on the circles where two neighbours meet.
  const Vec3 along = (cone->b - cone->a) / length, beside = along.unitOrthogonal();
  for (std::size_t i = 0; i + 1 < out.volumes.size(); ++i) {
    const auto &a = std::get<BallVolume>(out.volumes[i]), &b = std::get<BallVolume>(out.volumes[i + 1]);
    const double gap = length / steps;
    const double x = (gap * gap + a.radius * a.radius - b.radius * b.radius) / (2 * gap);
    const double height = std::sqrt(std::max(0.0, a.radius * a.radius - x * x));
    out.off = std::max(out.off, -signed_distance(volume, a.center + x * along + height * beside));
  }
  return out;
}

SimpleVolumes without_ellipsoid(const Volume& volume) {
  if (std::holds_alternative<EllipsoidVolume>(volume)) return as_capsule(volume);
  return unchanged(without_inner_ball(volume));
}

}  // namespace spherechain::baker
