// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/volumes/fit_body.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace spherechain::baker {
namespace {

constexpr double kCoverage = 0.9;  // as the spheres' detect radius

using Groups = std::vector<std::vector<int>>;  // indices of samples

double area_of(const std::vector<BodySample>& samples, const std::vector<int>& own) {
  double area = 0;
  for (const int i : own) area += samples[static_cast<std::size_t>(i)].area;
  return area;
}

// Runs of equal area along a direction; none is empty.
Groups slabs(const std::vector<BodySample>& samples, std::vector<int> own, const Vec3& along, int count) {
  std::stable_sort(own.begin(), own.end(), [&](int a, int b) {
    return along.dot(samples[static_cast<std::size_t>(a)].point) <
           along.dot(samples[static_cast<std::size_t>(b)].point);
  });
  const double whole = area_of(samples, own);
  Groups out(static_cast<std::size_t>(count));
  double before = 0;
  for (const int i : own) {
    const double area = samples[static_cast<std::size_t>(i)].area;
    const auto slab = static_cast<int>((before + area / 2) / whole * count);
    out[static_cast<std::size_t>(std::clamp(slab, 0, count - 1))].push_back(i);
    before += area;
  }
  std::erase_if(out, [](const std::vector<int>& one) { return one.empty(); });
  return out;
}

// The ways to begin: slabs along each of the two longest axes, or two rows of them.
std::vector<Groups> beginnings(const std::vector<BodySample>& samples, int count) {
  std::vector<int> all(samples.size());
  std::iota(all.begin(), all.end(), 0);
  if (count == 1) return {{all}};
  const Eigen::Matrix3d axes = main_axes(samples, all);
  std::vector<Groups> out{slabs(samples, all, axes.col(0), count), slabs(samples, all, axes.col(1), count)};
  if (count >= 4 && count % 2 == 0) {
    Groups rows;
    for (const std::vector<int>& row : slabs(samples, all, axes.col(1), 2)) {
      for (std::vector<int>& one : slabs(samples, row, axes.col(0), count / 2)) rows.push_back(std::move(one));
    }
    out.push_back(std::move(rows));
  }
  return out;
}

Groups nearest(const std::vector<BodySample>& samples, const std::vector<Volume>& volumes) {
  Groups out(volumes.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    std::size_t best = 0;
    double least = INFINITY;
    for (std::size_t k = 0; k < volumes.size(); ++k) {
      const double distance = signed_distance(volumes[k], samples[i].point);
      if (distance < least) {
        least = distance;
        best = k;
      }
    }
    out[best].push_back(static_cast<int>(i));
  }
  return out;
}

double gap_of(const std::vector<BodySample>& samples, const std::vector<Volume>& volumes) {
  double gap = 0;
  for (const BodySample& sample : samples) {
    double least = INFINITY;
    for (const Volume& volume : volumes) least = std::min(least, signed_distance(volume, sample.point));
    gap += sample.area * std::abs(least);
  }
  return gap;
}

BodyFit fit_from(VolumeShape shape, const BodySkin& skin, Groups groups) {
  constexpr int kRounds = 3;
  const std::vector<BodySample>& samples = skin.samples;
  std::vector<Volume> volumes;
  for (const std::vector<int>& own : groups) volumes.push_back(fit_one(shape, skin, own, std::nullopt));
  for (int round = 0; round < kRounds && volumes.size() > 1; ++round) {
    Groups next = nearest(samples, volumes);
    // One that is left with next to nothing is not needed.
    std::vector<Volume> kept;
    Groups kept_groups;
    for (std::size_t k = 0; k < next.size(); ++k) {
      if (next[k].size() < 3) continue;
      kept.push_back(volumes[k]);
      kept_groups.push_back(std::move(next[k]));
    }
    if (kept.empty()) break;
    const bool is_same = kept_groups == groups;
    groups = std::move(kept_groups);
    volumes = std::move(kept);
    if (is_same) break;
    for (std::size_t k = 0; k < volumes.size(); ++k) volumes[k] = fit_one(shape, skin, groups[k], volumes[k]);
  }
  BodyFit out;
  for (std::size_t k = 0; k < volumes.size(); ++k) {
    out.volumes.push_back(grown(volumes[k], samples, groups[k], kCoverage));
  }
  out.gap = gap_of(samples, out.volumes);
  return out;
}

}  // namespace

BodyFit fit_body(VolumeShape shape, const BodySkin& skin, int count) {
  BodyFit best;
  best.gap = INFINITY;
  for (Groups& groups : beginnings(skin.samples, count)) {
    BodyFit one = fit_from(shape, skin, std::move(groups));
    if (one.gap < best.gap) best = std::move(one);
  }
  return best;
}

}  // namespace spherechain::baker
