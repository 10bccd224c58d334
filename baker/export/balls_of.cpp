// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>

#include "baker/export/robot.h"
#include "baker/mesh/even_directions.h"

namespace spherechain::baker {
namespace {

// `count` of the balls between a cone's two, their radii in a geometric series: every two neighbours leave the same gap
// in proportion to their radius.
std::vector<BallVolume> balls_along(const ConeVolume& cone, int count) {
  const bool a_is_large = cone.radius_a >= cone.radius_b;
  const Vec3 large = a_is_large ? cone.a : cone.b, small = a_is_large ? cone.b : cone.a;
  const double most = std::max(cone.radius_a, cone.radius_b), least = std::min(cone.radius_a, cone.radius_b);
  const double ratio = std::max(least / most, 0.05);
  std::vector<BallVolume> out;
  for (int k = 0; k < count; ++k) {
    const double step = static_cast<double>(k) / (count - 1);
    const double t = k == count - 1 || ratio > 0.999 ? step : (1 - std::pow(ratio, step)) / (1 - least / most);
    out.push_back({large + t * (small - large), most + t * (least - most)});
  }
  return out;
}

// How far the circle in which two balls of a cone meet lies under its surface, in smaller radii.
double gap_between(const ConeVolume& cone, const BallVolume& a, const BallVolume& b) {
  const Vec3 axis = b.center - a.center;
  const double distance = axis.norm();
  const double along = (distance * distance + a.radius * a.radius - b.radius * b.radius) / (2 * distance);
  const double square = a.radius * a.radius - along * along;
  if (square <= 0) return INFINITY;  // they do not meet
  const Vec3 circle = a.center + along / distance * axis + std::sqrt(square) * axis.unitOrthogonal();
  return -signed_distance(cone, circle) / std::min(a.radius, b.radius);
}

std::vector<BallVolume> balls_in(const ConeVolume& cone) {
  constexpr double kGapMax = 0.05;
  constexpr int kBallsMax = 64;
  if ((cone.b - cone.a).norm() <= std::abs(cone.radius_a - cone.radius_b)) {
    return {cone.radius_a >= cone.radius_b ? BallVolume{cone.a, cone.radius_a} : BallVolume{cone.b, cone.radius_b}};
  }
  for (int count = 2;; ++count) {
    std::vector<BallVolume> out = balls_along(cone, count);
    const double gap = gap_between(cone, out[0], out[1]);
    if (gap > kGapMax && count < kBallsMax) continue;
    for (BallVolume& ball : out) ball.radius *= 1 + std::min(gap, kGapMax) / 2;  // as far beyond as short
    return out;
  }
}

// Greedily: of balls around points of a grid, each as large as may be, the one that covers the most of the surface.
template <typename Solid>
std::vector<BallVolume> balls_over(const Solid& solid, const Vec3& half, bool is_box) {
  constexpr double kBeyond = 0.1;  // of the smallest half
  constexpr int kSteps = 4, kBallsMax = 48;
  const auto place = [&](const Vec3& p) -> Vec3 { return solid.center + solid.rotation * half.cwiseProduct(p); };
  std::vector<Vec3> bare;
  for (const Vec3& u : even_directions(256)) bare.push_back(place(is_box ? u / u.cwiseAbs().maxCoeff() : u));
  std::vector<Vec3> normals = even_directions(128);
  for (int k = 0; k < 3; ++k) {
    normals.emplace_back(solid.rotation * Vec3::Unit(k));
    normals.emplace_back(solid.rotation * -Vec3::Unit(k));
  }
  std::vector<BallVolume> balls;
  for (int x = -kSteps; x <= kSteps; ++x) {
    for (int y = -kSteps; y <= kSteps; ++y) {
      for (int z = -kSteps; z <= kSteps; ++z) {
        const Vec3 center = place(Vec3(x, y, z) / (kSteps + 0.5));
        double depth = INFINITY;  // to the nearest plane that touches the solid
        for (const Vec3& n : normals) depth = std::min(depth, n.dot(support(solid, n) - center));
        if (depth > 0) balls.push_back({center, depth + kBeyond * half.minCoeff()});
      }
    }
  }
  std::vector<BallVolume> out;
  while (!bare.empty() && out.size() < kBallsMax) {
    const auto covers = [&](const BallVolume& ball) {
      return std::count_if(bare.begin(), bare.end(),
                           [&](const Vec3& p) { return (p - ball.center).squaredNorm() <= ball.radius * ball.radius; });
    };
    std::ptrdiff_t most = 0;
    const BallVolume* best = nullptr;
    for (const BallVolume& ball : balls) {
      const std::ptrdiff_t count = covers(ball);
      if (count > most) {
        most = count;
        best = &ball;
      }
    }
    if (best == nullptr) break;
    out.push_back(*best);
    bare.erase(
        std::remove_if(bare.begin(), bare.end(),
                       [&](const Vec3& p) { return (p - best->center).squaredNorm() <= best->radius * best->radius; }),
        bare.end());
  }
  return out;
}

}  // namespace

std::vector<BallVolume> balls_of(const Volume& volume) {
  if (const auto* cone = std::get_if<ConeVolume>(&volume)) return balls_in(*cone);
  if (const auto* ellipsoid = std::get_if<EllipsoidVolume>(&volume)) {
    return balls_over(*ellipsoid, ellipsoid->radii, false);
  }
  if (const auto* box = std::get_if<BoxVolume>(&volume)) return balls_over(*box, box->half, true);
  return {std::get<BallVolume>(volume)};
}

}  // namespace spherechain::baker
