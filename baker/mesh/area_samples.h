// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// Calls use(point, area) for points that stand for a triangle's area: the centroids of the equal triangles that it is
// cut into, so that no edge is longer than `fine`, or eight to an edge. The centroid of a long triangle alone says
// little about its ends.
template <typename Use>
void for_each_area_sample(const Mesh& mesh, std::size_t triangle, double fine, const Use& use) {
  constexpr double kCutsMax = 8;
  const Triangle& v = mesh.triangles[triangle];
  const Vec3 &a = mesh.positions[v[0]], &b = mesh.positions[v[1]], &c = mesh.positions[v[2]];
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  const auto cuts = static_cast<int>(std::clamp(std::ceil(longest / fine), 1.0, kCutsMax));
  const double area = triangle_area(mesh, triangle) / (cuts * cuts);
  const Vec3 u = (b - a) / cuts, w = (c - a) / cuts;
  for (int i = 0; i < cuts; ++i) {
    for (int j = 0; i + j < cuts; ++j) {
      const Vec3 corner = a + i * u + j * w;
      use(Vec3(corner + (u + w) / 3), area);
      if (i + j + 1 < cuts) use(Vec3(corner + 2 * (u + w) / 3), area);
    }
  }
}

}  // namespace spherechain::baker
