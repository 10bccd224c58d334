// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/ring.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace spherechain::baker {

double Ring::median_distance() const {
  std::vector<double> distances;
  for (const auto& hit : hits) {
    if (hit) distances.push_back(hit->distance);
  }
  if (distances.empty()) return 0;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

Vec3 Ring::section_centroid() const {
  std::vector<Vec3> corners;
  for (const auto& hit : hits) {
    if (hit) corners.push_back(hit->point);
  }
  if (corners.size() < 3) return center;
  Vec3 sum = Vec3::Zero();
  double area = 0;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec3 &a = corners[k], &b = corners[(k + 1) % corners.size()];
    const double twice = (a - center).cross(b - center).dot(normal);
    sum += twice * (center + a + b) / 3.0;
    area += twice;
  }
  return area > 0 ? Vec3(sum / area) : center;
}

Ring cast_ring(const SurfaceQuery& surface, const Vec3& center, const Vec3& normal, const Vec3& reference, int rays) {
  Ring ring{center, normal.normalized(), {}, {}, {}};
  ring.u = (reference - reference.dot(ring.normal) * ring.normal).normalized();
  ring.v = ring.normal.cross(ring.u);
  ring.hits.reserve(static_cast<std::size_t>(rays));
  for (int k = 0; k < rays; ++k) {
    const double angle = 2 * std::numbers::pi * k / rays;
    ring.hits.push_back(surface.first_hit(center, std::cos(angle) * ring.u + std::sin(angle) * ring.v));
  }
  return ring;
}

}  // namespace spherechain::baker
