// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/edits/region_axes.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "baker/mesh/decompose.h"

namespace spherechain::baker {
namespace {

constexpr double kLong = 1.5;    // of the second moments: a region is longer one way than the others
constexpr double kAway = 0.1;    // of the length: how far from the middle a region is that has an outer end
constexpr double kAlike = 0.85;  // cosine: forward is no direction across

// Area and moments of triangles; a triangle counts as a whole, so that cutting it changes nothing.
struct Moments {
  double area = 0;
  Vec3 centroid = Vec3::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  // about the centroid
};

Moments moments_of(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles) {
  Moments out;
  const auto each = [&](const auto& use) {
    for (const Triangle& t : triangles) {
      const Vec3 &a = positions[t[0]], &b = positions[t[1]], &c = positions[t[2]];
      use(a, b, c, 0.5 * (b - a).cross(c - a).norm());
    }
  };
  each([&](const Vec3& a, const Vec3& b, const Vec3& c, double area) {
    out.area += area;
    out.centroid += area * (a + b + c) / 3;
  });
  if (out.area > 0) out.centroid /= out.area;
  each([&](Vec3 a, Vec3 b, Vec3 c, double area) {
    for (Vec3* p : {&a, &b, &c}) *p -= out.centroid;
    const Vec3 sum = a + b + c;
    out.second += area / 12 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  });
  return out;
}

}  // namespace

Vec3 RegionAxes::point(const SpherePlace& place) const {
  return start + length * (place.along * axis + place.across[0] * across[0] + place.across[1] * across[1]);
}

namespace {

RegionAxes axes_of(const BodyFrame& frame, const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles,
                   const Vec3& middle) {
  const Moments moments = moments_of(positions, triangles);
  const PrincipalAxes principal = principal_axes(moments.second);
  RegionAxes out;
  const bool is_long = principal.values[2] > kLong * principal.values[1];
  out.axis = is_long ? Vec3(principal.vectors.col(2)) : frame.up;
  double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
  for (const Triangle& t : triangles) {
    for (const Index v : t) {
      const double at = (positions[v] - moments.centroid).dot(out.axis);
      low = std::min(low, at);
      high = std::max(high, at);
    }
  }
  out.length = triangles.empty() ? frame.height : std::max(high - low, 1e-9 * frame.height);
  const double away = out.axis.dot(moments.centroid - middle);
  const bool has_outer_end = std::abs(away) > kAway * out.length;
  // Axes of regions in the middle point up, or else forward.
  const double sign = has_outer_end ? away : out.axis.dot(frame.up + 0.5 * frame.forward + 0.1 * frame.left);
  if (sign < 0) {
    out.axis = -out.axis;
    low = -high;
  }
  if (triangles.empty()) low = 0;
  const Vec3& aside = std::abs(out.axis.dot(frame.forward)) > kAlike ? frame.up : frame.forward;
  out.across[0] = (aside - aside.dot(out.axis) * out.axis).normalized();
  out.across[1] = out.axis.cross(out.across[0]);
  out.start = moments.centroid + low * out.axis;
  return out;
}

}  // namespace

std::vector<RegionAxes> region_axes(const BodyFrame& frame, const Mesh& skin, const std::vector<std::uint8_t>& of_skin,
                                    std::size_t count) {
  std::vector<std::vector<Triangle>> triangles(count);
  for (std::size_t t = 0; t < of_skin.size(); ++t) {
    if (of_skin[t] < count) triangles[of_skin[t]].push_back(skin.triangles[t]);
  }
  const Vec3 middle = surface_centroid(skin);
  std::vector<RegionAxes> out;
  for (const std::vector<Triangle>& of_region : triangles) {
    out.push_back(axes_of(frame, skin.positions, of_region, middle));
  }
  return out;
}

}  // namespace spherechain::baker
