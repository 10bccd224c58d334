// SPDX-License-Identifier: GPL-3.0-or-later
// Voxels stand in columns. A column's axis crosses the skin at heights; from one to the next the winding number stays.
#include "baker/score/voxel_volume.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace spherechain::baker {
namespace {

struct Crossing {
  std::int64_t column;
  double height;
  int side;  // 1: upward through a side that looks down: into the body

  bool operator<(const Crossing& of) const { return column != of.column ? column < of.column : height < of.height; }
};

double side_of(const Vec3& a, const Vec3& b, double x, double y) {
  return (b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x());
}

// Does (x, y) lie left of a to b? A point on the edge lies left of one of its two triangles alone.
bool is_left(const Vec3& a, const Vec3& b, double side) {
  return side > 0 || (side == 0 && (a.y() > b.y() || (a.y() == b.y() && a.x() < b.x())));
}

}  // namespace

VoxelVolume::VoxelVolume(const std::vector<Vec3>& rest, const std::vector<Triangle>& triangles)
    : triangles_(triangles), radius_(0) {
  Eigen::AlignedBox3d box;
  for (const Triangle& t : triangles) {
    for (const Index v : t) box.extend(rest[v]);
  }
  for (const Triangle& t : triangles) {
    for (const Index v : t) radius_ = std::max(radius_, (rest[v] - box.center()).norm());
  }
}

double VoxelVolume::share(const std::vector<Vec3>& positions, double voxel) const {
  const double side = voxel * radius_;
  constexpr std::int64_t kColumns = std::int64_t{1} << 24;
  std::vector<Crossing> crossings;
  for (const Triangle& t : triangles_) {
    Vec3 a = positions[t[0]], b = positions[t[1]], c = positions[t[2]];
    const double area = side_of(a, b, c.x(), c.y());
    if (area == 0) continue;
    if (area < 0) std::swap(b, c);
    const auto first = [&](double least) { return static_cast<std::int64_t>(std::ceil(least / side - 0.5)); };
    const auto last = [&](double most) { return static_cast<std::int64_t>(std::floor(most / side - 0.5)); };
    const std::int64_t x_end = last(std::max({a.x(), b.x(), c.x()})), y_end = last(std::max({a.y(), b.y(), c.y()}));
    for (std::int64_t i = first(std::min({a.x(), b.x(), c.x()})); i <= x_end; ++i) {
      for (std::int64_t k = first(std::min({a.y(), b.y(), c.y()})); k <= y_end; ++k) {
        const double x = (static_cast<double>(i) + 0.5) * side, y = (static_cast<double>(k) + 0.5) * side;
        const double of_c = side_of(a, b, x, y), of_a = side_of(b, c, x, y), of_b = side_of(c, a, x, y);
        if (!is_left(a, b, of_c) || !is_left(b, c, of_a) || !is_left(c, a, of_b)) continue;
        const double z = (of_a * a.z() + of_b * b.z() + of_c * c.z()) / (of_a + of_b + of_c);
        crossings.push_back({i * kColumns + k, z, area < 0 ? 1 : -1});
      }
    }
  }
  std::sort(crossings.begin(), crossings.end());
  double inside = 0, twice = 0;
  int winding = 0;
  for (std::size_t c = 0; c + 1 < crossings.size(); ++c) {
    const Crossing &here = crossings[c], &next = crossings[c + 1];
    if (c == 0 || crossings[c - 1].column != here.column) winding = 0;
    winding += here.side;
    if (next.column != here.column || winding <= 0) continue;
    const double voxels = std::floor(next.height / side - 0.5) - std::floor(here.height / side - 0.5);
    inside += winding * voxels;
    twice += winding > 1 ? winding * voxels : 0;
  }
  return inside > 0 ? twice / inside : 0;
}

}  // namespace spherechain::baker
