// SPDX-License-Identifier: GPL-3.0-or-later
#include "volumes/measure.h"

#include <algorithm>
#include <cmath>

#include "volumes/bodies.h"

namespace spherechain::baker {
namespace {

struct PlacedVolume {
  Volume volume;  // in the rest pose
  Vec3 low, high;
};

std::vector<PlacedVolume> placed_volumes(const Colliders& colliders) {
  std::vector<PlacedVolume> out;
  for (const ColliderBody& body : colliders.bodies) {
    for (const Volume& volume : body.volumes) {
      PlacedVolume one{moved(volume, Affine(body.rest)), Vec3::Zero(), Vec3::Zero()};
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

// Of the rest pose by its triangles' signed cones to a point: of the pieces that are closed exact, of open ones nearly.
double enclosed_volume(const std::vector<SkinSample>& skin) {
  double out = 0;
  for (const SkinSample& sample : skin) out += sample.area * sample.normal.dot(sample.point - skin.front().point) / 3;
  return out;
}

}  // namespace

ColliderFit measure_fit(const OpenAsset& asset, const Colliders& colliders) {
  constexpr int kSamplesOfBody = 2000;
  const std::vector<SkinSample> skin = sample_skin(asset, colliders, kSamplesOfBody);
  const std::vector<PlacedVolume> volumes = placed_volumes(colliders);
  ColliderFit out;
  out.volumes = static_cast<int>(volumes.size());
  for (const ColliderBody& body : colliders.bodies) out.bodies += body.volumes.empty() ? 0 : 1;
  if (volumes.empty() || skin.empty()) return out;
  double area = 0;
  std::vector<std::pair<double, double>> gaps, protrusions;
  for (const SkinSample& sample : skin) {
    double least = INFINITY;
    for (const PlacedVolume& one : volumes) least = std::min(least, signed_distance(one.volume, sample.point));
    area += sample.area;
    out.coverage += least <= 0 ? sample.area : 0;
    out.gap_mean += sample.area * std::abs(least);
    gaps.emplace_back(std::abs(least), sample.area);
    protrusions.emplace_back(std::max(-least, 0.0), sample.area);
  }
  out.coverage /= area;
  out.gap_mean /= area;
  out.gap_95 = weighted_quantile(std::move(gaps), 0.95);
  out.protrusion_95 = weighted_quantile(std::move(protrusions), 0.95);
  const double enclosed = enclosed_volume(skin);
  out.volume_ratio = enclosed > 0 ? union_volume(volumes) / enclosed : 0;
  return out;
}

}  // namespace spherechain::baker
