// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "baker/volumes/volume.h"

// The algorithm of Gilbert, Johnson and Keerthi: two convex solids share a point where the differences of their points
// hold the origin. A simplex of such differences walks towards it.
namespace spherechain::baker {
namespace {

struct DifferenceSimplex {
  std::array<Vec3, 4> points{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  std::size_t count = 0;

  void keep(std::initializer_list<std::size_t> which) {
    std::array<Vec3, 4> kept = points;
    std::size_t n = 0;
    for (const std::size_t i : which) kept[n++] = points[i];
    points = kept;
    count = n;
  }
};

// Each of these drops the points that the nearest point to the origin does not need, and returns that point.
Vec3 nearest_on_segment(DifferenceSimplex& simplex) {
  const Vec3 a = simplex.points[0], ab = simplex.points[1] - a;
  const double t = -a.dot(ab), length = ab.squaredNorm();
  if (t <= 0 || length == 0) {
    simplex.keep({0});
    return a;
  }
  if (t >= length) {
    simplex.keep({1});
    return simplex.points[0];
  }
  return a + t / length * ab;
}

Vec3 nearest_on_triangle(DifferenceSimplex& simplex) {
  const Vec3 a = simplex.points[0], b = simplex.points[1], c = simplex.points[2];
  const Vec3 normal = (b - a).cross(c - a);
  const double area = normal.squaredNorm();
  // Barycentric coordinates of the origin's image on the plane.
  const double wa = normal.dot(b.cross(c)), wb = normal.dot(c.cross(a)), wc = normal.dot(a.cross(b));
  if (area > 0 && wa >= 0 && wb >= 0 && wc >= 0) return normal.dot(a) / area * normal;
  Vec3 best = Vec3::Constant(INFINITY);
  DifferenceSimplex kept = simplex;
  for (const auto& [i, j] : {std::array<std::size_t, 2>{0, 1}, {1, 2}, {0, 2}}) {
    DifferenceSimplex edge = simplex;
    edge.keep({i, j});
    const Vec3 point = nearest_on_segment(edge);
    if (point.squaredNorm() < best.squaredNorm()) {
      best = point;
      kept = edge;
    }
  }
  simplex = kept;
  return best;
}

Vec3 nearest_on_tetrahedron(DifferenceSimplex& simplex) {
  const auto& p = simplex.points;
  bool inside = true;
  Vec3 best = Vec3::Constant(INFINITY);
  DifferenceSimplex kept = simplex;
  for (const auto& [i, j, k, l] : {std::array<std::size_t, 4>{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}}) {
    const Vec3 normal = (p[j] - p[i]).cross(p[k] - p[i]);
    const double origin = normal.dot(-p[i]), other = normal.dot(p[l] - p[i]);
    if (other != 0 && origin * other >= 0) continue;  // on the inner side of this face
    inside = false;
    DifferenceSimplex face = simplex;
    face.keep({i, j, k});
    const Vec3 point = nearest_on_triangle(face);
    if (point.squaredNorm() < best.squaredNorm()) {
      best = point;
      kept = face;
    }
  }
  if (inside) return Vec3::Zero();
  simplex = kept;
  return best;
}

Vec3 nearest(DifferenceSimplex& simplex) {
  switch (simplex.count) {
    case 1:
      return simplex.points[0];
    case 2:
      return nearest_on_segment(simplex);
    case 3:
      return nearest_on_triangle(simplex);
    default:
      return nearest_on_tetrahedron(simplex);
  }
}

BallVolume ball_around(const BallVolume& ball) { return ball; }
BallVolume ball_around(const ConeVolume& cone) {
  return {(cone.a + cone.b) / 2, (cone.b - cone.a).norm() / 2 + std::max(cone.radius_a, cone.radius_b)};
}
BallVolume ball_around(const EllipsoidVolume& ellipsoid) { return {ellipsoid.center, ellipsoid.radii.maxCoeff()}; }
BallVolume ball_around(const BoxVolume& box) { return {box.center, box.half.norm()}; }

BallVolume bounds_of(const Volume& volume, const Eigen::Isometry3d& to_world) {
  const BallVolume ball = std::visit([](const auto& one) { return ball_around(one); }, volume);
  return {to_world * ball.center, ball.radius};
}

bool overlap_by_simplex(const Volume& a, const Volume& b, const Eigen::Isometry3d& b_to_a) {
  constexpr int kStepsMax = 200;
  constexpr double kTouching = 1e-9;  // metres
  const Eigen::Matrix3d a_to_b = b_to_a.linear().transpose();
  const auto difference = [&](const Vec3& direction) -> Vec3 {
    return support(a, direction) - b_to_a * support(b, -(a_to_b * direction));
  };
  DifferenceSimplex simplex;
  simplex.points[simplex.count++] = difference(Vec3::UnitX());
  Vec3 point = simplex.points[0];
  for (int step = 0; step < kStepsMax; ++step) {
    const double distance = point.norm();
    if (distance <= kTouching) return true;
    const Vec3 next = difference(-point);
    if (point.dot(next) > 0) return false;  // a plane lies between
    simplex.points[simplex.count++] = next;
    point = nearest(simplex);
    if (point.norm() >= distance * (1 - 1e-14) && step > 0) return false;  // no nearer: the origin is outside
  }
  return point.norm() <= 1e-6;
}

}  // namespace

bool overlap(const Volume& a, const Eigen::Isometry3d& a_to_world, const Volume& b,
             const Eigen::Isometry3d& b_to_world) {
  const BallVolume around_a = bounds_of(a, a_to_world), around_b = bounds_of(b, b_to_world);
  if ((around_a.center - around_b.center).norm() > around_a.radius + around_b.radius) return false;
  // The distance to an ellipsoid is not exact.
  if (std::holds_alternative<BallVolume>(a) && !std::holds_alternative<EllipsoidVolume>(b)) {
    return signed_distance(b, b_to_world.inverse(Eigen::Isometry) * around_a.center) <= around_a.radius;
  }
  if (std::holds_alternative<BallVolume>(b) && !std::holds_alternative<EllipsoidVolume>(a)) {
    return signed_distance(a, a_to_world.inverse(Eigen::Isometry) * around_b.center) <= around_b.radius;
  }
  return overlap_by_simplex(a, b, a_to_world.inverse(Eigen::Isometry) * b_to_world);
}

}  // namespace spherechain::baker
