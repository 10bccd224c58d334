// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/volumes/volume.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "baker/mesh/decompose.h"

namespace spherechain::baker {
namespace {

double distance_to(const BallVolume& ball, const Vec3& point) { return (point - ball.center).norm() - ball.radius; }

// In the plane through the axis the hull's outline is two arcs and their common tangent. The foot on the axis of the
// tangent's normal through the point tells which of the three is nearest.
double distance_to(const ConeVolume& cone, const Vec3& point) {
  const Vec3 axis = cone.b - cone.a;
  const double length = axis.norm(), taper = cone.radius_a - cone.radius_b;
  if (length <= std::abs(taper)) {
    return taper >= 0 ? distance_to(BallVolume{cone.a, cone.radius_a}, point)
                      : distance_to(BallVolume{cone.b, cone.radius_b}, point);
  }
  const Vec3 unit = axis / length;
  const double along = unit.dot(point - cone.a);
  const double beside = (point - cone.a - along * unit).norm();
  const double sine = taper / length, cosine = std::sqrt(1 - sine * sine);
  const double foot = along - beside * sine / cosine;  // the normal leans towards the smaller ball
  const double t = std::clamp(foot / length, 0.0, 1.0);
  return (point - cone.a - t * axis).norm() - (cone.radius_a - t * taper);
}

double distance_to(const EllipsoidVolume& ellipsoid, const Vec3& point) {
  const Vec3 local = ellipsoid.rotation.conjugate() * (point - ellipsoid.center);
  const Vec3 scaled = local.cwiseQuotient(ellipsoid.radii);
  const double k = scaled.norm(), gradient = scaled.cwiseQuotient(ellipsoid.radii).norm();
  return gradient <= 0 ? -ellipsoid.radii.minCoeff() : k * (k - 1) / gradient;
}

double distance_to(const BoxVolume& box, const Vec3& point) {
  const Vec3 outside = (box.rotation.conjugate() * (point - box.center)).cwiseAbs() - box.half;
  return outside.cwiseMax(0).norm() + std::min(outside.maxCoeff(), 0.0);
}

Vec3 farthest(const BallVolume& ball, const Vec3& direction) { return ball.center + ball.radius * direction; }

Vec3 farthest(const ConeVolume& cone, const Vec3& direction) {
  const Vec3 a = cone.a + cone.radius_a * direction, b = cone.b + cone.radius_b * direction;
  return a.dot(direction) >= b.dot(direction) ? a : b;
}

Vec3 farthest(const EllipsoidVolume& ellipsoid, const Vec3& direction) {
  const Vec3 stretched = ellipsoid.radii.cwiseProduct(ellipsoid.rotation.conjugate() * direction);
  return ellipsoid.center + ellipsoid.rotation * ellipsoid.radii.cwiseProduct(stretched.normalized());
}

Vec3 farthest(const BoxVolume& box, const Vec3& direction) {
  const Vec3 local = box.rotation.conjugate() * direction;
  return box.center + box.rotation * Vec3(std::copysign(box.half.x(), local.x()),
                                          std::copysign(box.half.y(), local.y()),
                                          std::copysign(box.half.z(), local.z()));
}

double content(const BallVolume& ball) { return 4.0 / 3 * std::numbers::pi * std::pow(ball.radius, 3); }

// Two caps and the frustum between the circles where they touch it.
double content(const ConeVolume& cone) {
  const double length = (cone.b - cone.a).norm(), taper = cone.radius_a - cone.radius_b;
  if (length <= std::abs(taper)) return content(BallVolume{cone.a, std::max(cone.radius_a, cone.radius_b)});
  const double sine = taper / length, cosine = std::sqrt(1 - sine * sine);
  const auto cap = [](double radius, double height) {
    return std::numbers::pi * height * height * (radius - height / 3);
  };
  const double a = cone.radius_a * cosine, b = cone.radius_b * cosine;
  const double height = length - taper * sine;
  return cap(cone.radius_a, cone.radius_a * (1 + sine)) + cap(cone.radius_b, cone.radius_b * (1 - sine)) +
         std::numbers::pi / 3 * height * (a * a + a * b + b * b);
}

double content(const EllipsoidVolume& ellipsoid) { return 4.0 / 3 * std::numbers::pi * ellipsoid.radii.prod(); }
double content(const BoxVolume& box) { return 8 * box.half.prod(); }

}  // namespace

const char* volume_name(const Volume& volume) {
  if (const auto* cone = std::get_if<ConeVolume>(&volume)) {
    return cone->radius_a == cone->radius_b ? "capsule" : "cone";
  }
  constexpr const char* kNames[] = {"sphere", "cone", "ellipsoid", "box"};
  return kNames[volume.index()];
}

double signed_distance(const Volume& volume, const Vec3& point) {
  return std::visit([&](const auto& one) { return distance_to(one, point); }, volume);
}

Vec3 support(const Volume& volume, const Vec3& direction) {
  const Vec3 unit = direction.normalized();
  return std::visit([&](const auto& one) { return farthest(one, unit); }, volume);
}

double volume_of(const Volume& volume) {
  return std::visit([](const auto& one) { return content(one); }, volume);
}

Volume moved(const Volume& volume, const Eigen::AffineCompact3d& by) {
  const double scale = std::cbrt(std::abs(by.linear().determinant()));
  const Eigen::Quaterniond turn(turn_in(by.linear()));
  Volume out = volume;
  if (auto* ball = std::get_if<BallVolume>(&out)) {
    *ball = {by * ball->center, scale * ball->radius};
  } else if (auto* cone = std::get_if<ConeVolume>(&out)) {
    *cone = {by * cone->a, by * cone->b, scale * cone->radius_a, scale * cone->radius_b};
  } else if (auto* ellipsoid = std::get_if<EllipsoidVolume>(&out)) {
    *ellipsoid = {by * ellipsoid->center, turn * ellipsoid->rotation, scale * ellipsoid->radii};
  } else if (auto* box = std::get_if<BoxVolume>(&out)) {
    *box = {by * box->center, turn * box->rotation, scale * box->half};
  }
  return out;
}

Volume padded(const Volume& volume, double by) {
  constexpr double kLengthMin = 1e-4;
  const auto longer = [&](double length) { return std::max(length + by, kLengthMin); };
  Volume out = volume;
  if (auto* ball = std::get_if<BallVolume>(&out)) {
    ball->radius = longer(ball->radius);
  } else if (auto* cone = std::get_if<ConeVolume>(&out)) {
    cone->radius_a = longer(cone->radius_a);
    cone->radius_b = longer(cone->radius_b);
  } else if (auto* ellipsoid = std::get_if<EllipsoidVolume>(&out)) {
    ellipsoid->radii = ellipsoid->radii.unaryExpr(longer);
  } else if (auto* box = std::get_if<BoxVolume>(&out)) {
    box->half = box->half.unaryExpr(longer);
  }
  return out;
}

}  // namespace spherechain::baker
