// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/bind/fit_quality.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "baker/mesh/area_samples.h"
#include "baker/mesh/even_directions.h"
#include "baker/mesh/surface_query.h"

namespace spherechain::baker {
namespace {

constexpr double kFairArea = 0.15;
constexpr double kGoodProtrusion = 0.025, kFairProtrusion = 0.04;

double protrusion_of(const Mesh& skin, const std::vector<BoundSphere>& spheres) {
  constexpr int kPoints = 100;  // of each sphere
  const SurfaceQuery surface(skin);
  const std::vector<Vec3> around = even_directions(kPoints);
  double sum = 0, area = 0;
  for (const BoundSphere& sphere : spheres) {
    const double radius = sphere.rest.radius;
    for (const Vec3& direction : around) {
      const Vec3 point = sphere.rest.center + radius * direction;
      const bool inside = std::any_of(spheres.begin(), spheres.end(), [&](const BoundSphere& other) {
        return &other != &sphere && (other.rest.center - point).norm() < other.rest.radius;
      });
      if (inside) continue;
      sum += radius * radius * surface.closest(point).distance;
      area += radius * radius;
    }
  }
  return area > 0 ? sum / area : 0;
}

}  // namespace

const char* fit_grade_name(FitGrade grade) {
  return grade == FitGrade::kGood ? "good" : grade == FitGrade::kFair ? "fair" : "poor";
}

FitGrade FitQuality::grade() const {
  if (far_area <= kFarAreaGood && protrusion <= kGoodProtrusion) return FitGrade::kGood;
  return far_area <= kFairArea && protrusion <= kFairProtrusion ? FitGrade::kFair : FitGrade::kPoor;
}

std::vector<std::uint8_t> FitQuality::far_regions() const {
  std::vector<std::uint8_t> out;
  for (std::uint8_t region = 0; region < far_of_region.size(); ++region) {
    if (far_of_region[region] > 0.5) out.push_back(region);
  }
  return out;
}

FitQuality measure_fit(const Character& character, const Regions& regions, const Binding& binding) {
  const Mesh& skin = character.skin;
  const double height = regions.frame.height;
  std::vector<std::pair<double, double>> distances;
  std::vector<double> area(regions.count(), 0), far(regions.count(), 0);
  double sum = 0, all = 0, all_far = 0;
  std::vector<std::set<std::uint32_t>> of_region(regions.count());
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    of_region[regions.of_skin[t]].insert(binding.sphere_of_triangle[t]);
  }
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    const std::uint8_t region = regions.of_skin[t];
    const bool by_bones = regions.is_by_bones(region);
    for_each_area_sample(skin, t, kWellFitted * height, [&](const Vec3& p, double own) {
      double distance = std::abs(signed_f(binding.spheres[binding.sphere_of_triangle[t]].rest, p)) / height;
      if (by_bones) {
        for (const std::uint32_t sphere : of_region[region]) {
          distance = std::min(distance, std::abs(signed_f(binding.spheres[sphere].rest, p)) / height);
        }
      }
      distances.emplace_back(distance, own);
      sum += own * distance;
      all += own;
      area[regions.of_skin[t]] += own;
      if (distance <= kWellFitted) return;
      all_far += own;
      far[regions.of_skin[t]] += own;
    });
  }
  FitQuality quality{sum / all,
                     weighted_quantile(distances, 0.95),
                     std::max_element(distances.begin(), distances.end())->first,
                     all_far / all,
                     protrusion_of(skin, binding.spheres) / height,
                     {}};
  for (std::size_t region = 0; region < regions.count(); ++region) {
    quality.far_of_region.push_back(area[region] > 0 ? far[region] / area[region] : 0);
  }
  return quality;
}

}  // namespace spherechain::baker
