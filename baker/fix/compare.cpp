// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "baker/mesh/surface_query.h"

namespace spherechain::baker {
namespace {

constexpr double kMoved = 3;  // mm

double degrees_between(const Affine& a, const Affine& b) {
  const double scale = std::cbrt(std::abs(a.linear().determinant()));
  const Eigen::Quaterniond p(Eigen::Matrix3d(a.linear() / scale)), q(Eigen::Matrix3d(b.linear() / scale));
  return p.angularDistance(q) * 180 / std::numbers::pi;
}

}  // namespace

Comparison compare(const TurnedClip& clip, const Turns& turns, const std::vector<Index>& feet,
                   const std::vector<Index>& wrists, double mm_per_unit) {
  const Turns none(turns.size(), Vec3::Zero());
  Comparison out;
  std::vector<std::vector<std::array<Vec3, 2>>> ways(wrists.size());  // before and after
  for (int f = 0; f < clip.frames(); ++f) {
    const TurnedClip::Pose before = clip.pose(f, none), after = clip.pose(f, turns);
    for (const Index foot : feet) {
      const Affine &a = before.axes[foot], &b = after.axes[foot];
      out.feet_mm = std::max(out.feet_mm, mm_per_unit * (a.translation() - b.translation()).norm());
      out.feet_degrees = std::max(out.feet_degrees, degrees_between(a, b));
    }
    for (std::size_t w = 0; w < wrists.size(); ++w) {
      ways[w].push_back({before.axes[wrists[w]].translation(), after.axes[wrists[w]].translation()});
    }
  }
  double sums[2] = {};
  for (const auto& way : ways) {
    for (std::size_t f = 3; f < way.size(); ++f) {
      if (mm_per_unit * (way[f - 1][0] - way[f - 1][1]).norm() < kMoved) continue;
      for (std::size_t k = 0; k < 2; ++k) {
        sums[k] += (way[f][k] - 3 * way[f - 1][k] + 3 * way[f - 2][k] - way[f - 3][k]).norm();
      }
    }
  }
  if (sums[0] > 0) out.jerk_ratio = sums[1] / sums[0];
  return out;
}

double distance_between(const AnimatedAsset& animated, const Deformation& pose, std::uint32_t part_a,
                        std::uint32_t part_b) {
  const BodyParts parts = body_parts_of(animated.asset());
  Mesh mesh;
  mesh.positions = animated.positions(pose);
  mesh.triangles = animated.character().source_triangles;
  const auto of = [&](std::uint32_t part) {
    std::vector<Index> out;
    for (Index t = 0; t < mesh.triangles.size(); ++t) {
      if (parts.of_triangle[t] == part) out.push_back(t);
    }
    return out;
  };
  const std::vector<Index> a = of(part_a), b = of(part_b);
  double least = HUGE_VAL;
  if (a.empty() || b.empty()) return least;
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
    const SurfaceQuery surface(mesh, to);
    for (const Index t : from) {
      for (const Index corner : mesh.triangles[t]) {
        least = std::min(least, surface.closest(mesh.positions[corner]).distance);
      }
    }
  }
  return least;
}

}  // namespace spherechain::baker
