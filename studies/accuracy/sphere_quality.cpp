// SPDX-License-Identifier: GPL-3.0-or-later
#include "sphere_quality.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace spherechain::baker {
namespace {

// The standard fixes the generator's numbers but not its distributions'.
class Uniform {
 public:
  double operator()() { return static_cast<double>(bits_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 bits_{1};
};

// The first triangle a ray from inside meets is seen from behind.
bool is_inside(const SurfaceQuery& surface, const Mesh& body, const Vec3& point) {
  const Vec3 direction(0.5377, 0.3188, 0.7803);  // along no axis a modeller would use
  const auto hit = surface.first_hit(point, direction);
  return hit && triangle_cross(body, hit->triangle).dot(direction) > 0;
}

double distance_to_union(const std::vector<Ball>& spheres, const Vec3& point) {
  double least = std::numeric_limits<double>::max();
  for (const Ball& s : spheres) least = std::min(least, (s.center - point).norm() - s.radius);
  return least;
}

double quantile_95(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

SampledBody::SampledBody(const Mesh& body, std::size_t count) : surface_(body) {
  Uniform uniform;
  Eigen::AlignedBox3d box;
  for (const Vec3& p : body.positions) box.extend(p);
  const Vec3 margin = Vec3::Constant(0.05 * box.sizes().maxCoeff());  // spheres may stick out
  box.extend(box.min() - margin);
  box.extend(box.max() + margin);
  while (inside_.size() < count) {
    const double x = uniform(), y = uniform(), z = uniform();
    const Vec3 point = box.min() + Vec3(x, y, z).cwiseProduct(box.sizes());
    if (is_inside(surface_, body, point)) {
      inside_.push_back({point, surface_.closest(point).triangle});
    } else {
      outside_.push_back(point);
    }
  }
  // Evenly along the area summed over the triangles.
  const double step = surface_area(body) / static_cast<double>(count);
  double sum = 0, next = 0.5 * step;
  for (Index t = 0; t < body.triangles.size(); ++t) {
    for (sum += triangle_area(body, t); next < sum; next += step) {
      double u = uniform(), v = uniform();
      if (u + v > 1) {
        u = 1 - u;
        v = 1 - v;
      }
      const auto& [a, b, c] = body.triangles[t];
      skin_.push_back({(1 - u - v) * body.positions[a] + u * body.positions[b] + v * body.positions[c], t});
    }
  }
}

SphereQuality SampledBody::measure(const std::vector<Ball>& spheres, const Part& part) const {
  double volume = 0, covered = 0;
  for (const Sample& sample : inside_) {
    if (!part(sample.triangle)) continue;
    ++volume;
    if (distance_to_union(spheres, sample.point) < 0) ++covered;
  }
  std::vector<double> depths;
  for (const Vec3& point : outside_) {
    if (distance_to_union(spheres, point) >= 0) continue;
    const SurfaceHit nearest = surface_.closest(point);
    if (part(nearest.triangle)) depths.push_back(nearest.distance);
  }
  std::vector<double> gaps;
  double gap_sum = 0, uncovered = 0;
  for (const Sample& sample : skin_) {
    if (!part(sample.triangle)) continue;
    gaps.push_back(std::max(0.0, distance_to_union(spheres, sample.point)));
    gap_sum += gaps.back();
    if (gaps.back() > 0) ++uncovered;
  }
  const double outside = static_cast<double>(depths.size()), skin = static_cast<double>(gaps.size());
  return {
      covered / volume,  outside / volume, (covered + outside) / volume, quantile_95(std::move(depths)), gap_sum / skin,
      quantile_95(gaps), uncovered / skin};
}

}  // namespace spherechain::baker
