// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/volumes/measure.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "baker/volumes/bodies.h"

namespace spherechain::baker {
namespace {

struct PlacedVolume {
  Volume volume;  // in the rest pose
  Vec3 low, high;
};

std::vector<PlacedVolume> placed_volumes(const Colliders& colliders, const std::vector<Eigen::Isometry3d>& at) {
  std::vector<PlacedVolume> out;
  for (std::size_t i = 0; i < at.size(); ++i) {
    for (const Volume& volume : colliders.bodies[i].volumes) {
      PlacedVolume one{moved(volume, Affine(at[i])), Vec3::Zero(), Vec3::Zero()};
      for (int axis = 0; axis < 3; ++axis) {
        one.low[axis] = support(one.volume, -Vec3::Unit(axis))[axis];
        one.high[axis] = support(one.volume, Vec3::Unit(axis))[axis];
      }
      out.push_back(std::move(one));
    }
  }
  return out;
}

// By points of an even grid.
double union_volume(const std::vector<PlacedVolume>& volumes) {
  constexpr double kPoints = 200000;
  Vec3 low = Vec3::Constant(INFINITY), high = Vec3::Constant(-INFINITY);
  for (const PlacedVolume& one : volumes) {
    low = low.cwiseMin(one.low);
    high = high.cwiseMax(one.high);
  }
  if (volumes.empty() || !((high - low).minCoeff() > 0)) return 0;
  const double cell = std::cbrt((high - low).prod() / kPoints);
  const Eigen::Array3i count = ((high - low) / cell).array().ceil().cast<int>();
  const auto cells = [&](int axis) { return static_cast<std::size_t>(count[axis]); };
  std::vector<bool> is_in(cells(0) * cells(1) * cells(2), false);
  for (const PlacedVolume& one : volumes) {
    const Eigen::Array3i from = ((one.low - low) / cell - Vec3::Constant(0.5)).array().ceil().cast<int>().max(0);
    const Eigen::Array3i to =
        ((one.high - low) / cell - Vec3::Constant(0.5)).array().floor().cast<int>().min(count - 1);
    for (int z = from[2]; z <= to[2]; ++z) {
      for (int y = from[1]; y <= to[1]; ++y) {
        for (int x = from[0]; x <= to[0]; ++x) {
          const Vec3 point = low + cell * Vec3(x + 0.5, y + 0.5, z + 0.5);
          if (signed_distance(one.volume, point) > 0) continue;
          is_in[(static_cast<std::size_t>(z) * cells(1) + static_cast<std::size_t>(y)) * cells(0) +
                static_cast<std::size_t>(x)] = true;
        }
      }
    }
  }
  return static_cast<double>(std::count(is_in.begin(), is_in.end(), true)) * cell * cell * cell;
}

// Volume at rest by the signed cones from triangles to a point: exact for closed pieces, approximate for open ones.
double enclosed_volume(const std::vector<SkinSample>& skin) {
  double out = 0;
  for (const SkinSample& sample : skin) out += sample.area * sample.normal.dot(sample.point - skin.front().point) / 3;
  return out;
}

// All but the volume ratio.
ColliderFit fit_of(const std::vector<SkinSample>& skin, const Colliders& colliders,
                   const std::vector<PlacedVolume>& volumes) {
  ColliderFit out;
  out.volumes = static_cast<int>(volumes.size());
  for (const ColliderBody& body : colliders.bodies) out.bodies += body.volumes.empty() ? 0 : 1;
  if (volumes.empty() || skin.empty()) return out;
  double area = 0;
  std::vector<double> area_of_body(colliders.bodies.size(), 0), inside_of_body = area_of_body;
  std::vector<std::pair<double, double>> gaps, protrusions;
  for (const SkinSample& sample : skin) {
    double least = INFINITY;
    for (const PlacedVolume& one : volumes) least = std::min(least, signed_distance(one.volume, sample.point));
    area += sample.area;
    area_of_body[static_cast<std::size_t>(sample.body)] += sample.area;
    inside_of_body[static_cast<std::size_t>(sample.body)] += least <= 0 ? sample.area : 0;
    out.gap_mean += sample.area * std::abs(least);
    gaps.emplace_back(std::abs(least), sample.area);
    protrusions.emplace_back(std::max(-least, 0.0), sample.area);
  }
  out.coverage = std::accumulate(inside_of_body.begin(), inside_of_body.end(), 0.0) / area;
  for (std::size_t i = 0; i < area_of_body.size(); ++i) {
    out.coverage_of_body.push_back(area_of_body[i] > 0 ? inside_of_body[i] / area_of_body[i] : 1);
  }
  out.gap_mean /= area;
  out.gap_95 = weighted_quantile(std::move(gaps), 0.95);
  out.protrusion_95 = weighted_quantile(std::move(protrusions), 0.95);
  return out;
}

constexpr int kMeasuredOfBody = 500;  // samples

}  // namespace

ColliderFit measure_fit(const OpenAsset& asset, const Colliders& colliders) {
  const std::vector<SkinSample> skin = sample_skin(asset, colliders, skin_positions(asset), kMeasuredOfBody);
  const std::vector<PlacedVolume> volumes = placed_volumes(colliders, at_rest(colliders));
  ColliderFit out = fit_of(skin, colliders, volumes);
  const double enclosed = skin.empty() ? 0 : enclosed_volume(skin);
  out.volume_ratio = enclosed > 0 ? union_volume(volumes) / enclosed : 0;
  return out;
}

ColliderFit measure_fit(const AnimatedAsset& animated, const Colliders& colliders, int frames) {
  ColliderFit out;
  out.coverage_of_body.resize(colliders.bodies.size(), 0);
  const int count = std::min(frames, animated.frame_count());
  for (int i = 0; i < count; ++i) {
    const Deformation pose = animated.deformation(static_cast<int>(std::int64_t{i} * animated.frame_count() / count));
    const std::vector<Vec3> positions = skin_positions(animated.asset(), animated.positions(pose));
    const ColliderFit one = fit_of(sample_skin(animated.asset(), colliders, positions, kMeasuredOfBody), colliders,
                                   placed_volumes(colliders, posed(colliders, pose.bones)));
    out.volumes = one.volumes;
    out.bodies = one.bodies;
    out.coverage += one.coverage / count;
    for (std::size_t k = 0; k < one.coverage_of_body.size(); ++k) {
      out.coverage_of_body[k] += one.coverage_of_body[k] / count;
    }
    out.gap_mean += one.gap_mean / count;
    out.gap_95 += one.gap_95 / count;
    out.protrusion_95 += one.protrusion_95 / count;
  }
  return out;
}

}  // namespace spherechain::baker
