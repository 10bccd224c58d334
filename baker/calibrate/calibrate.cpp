// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibrate/calibrate.h"

#include <algorithm>

#include "calibrate/random_poses.h"
#include "calibrate/reach.h"
#include "calibrate/samples.h"
#include "calibrate/skin_gap.h"

namespace spherechain::baker {
namespace {

constexpr double kClose = 0.003;   // of the height: skins that are this near at rest always count
constexpr double kGapShare = 0.6;  // of the gap must close
constexpr double kNear = 0.9;      // spheres nearly touch where this part of their distance is within their radii
constexpr std::size_t kTriangles = 30'000'000;  // of all poses together, at most

std::vector<Pair> tested_pairs(const Binding& binding) {
  std::vector<Pair> out;
  for (std::uint32_t a = 0; a < binding.spheres.size(); ++a) {
    for (std::uint32_t b = a + 1; b < binding.spheres.size(); ++b) {
      if (!std::binary_search(binding.ignored.begin(), binding.ignored.end(), std::pair(a, b))) out.push_back({a, b});
    }
  }
  return out;
}

std::vector<SampledPair> sampled_pairs(const Character& character, const std::vector<Joint>& joints,
                                       const std::vector<std::uint8_t>& asset, const std::vector<Pair>& pairs) {
  const RandomPoses poses(character, joints);
  if (poses.any() && !pairs.empty()) {
    const std::size_t fitting = kTriangles / character.skin.triangles.size() + 1;
    return sample_pairs(asset, pairs, poses, static_cast<int>(std::min<std::size_t>(kCalibrationPoses, fitting)));
  }
  std::vector<SampledPair> out;
  for (const Pair& pair : pairs) out.push_back({pair, {}});
  return out;
}

double rest_distance(const Binding& binding, const Pair& pair) {
  return (binding.spheres[pair.a].rest.center - binding.spheres[pair.b].rest.center).norm();
}

double radius_sum(const Binding& binding, const Pair& pair, double BoundSphere::*detect) {
  const BoundSphere &a = binding.spheres[pair.a], &b = binding.spheres[pair.b];
  return detect ? a.*detect + b.*detect : a.rest.radius + b.rest.radius;
}

}  // namespace

void calibrate(const Character& character, const Regions& regions, const std::vector<Joint>& joints,
               const std::vector<std::uint8_t>& asset, Binding& binding) {
  const std::vector<Pair> pairs = tested_pairs(binding);
  const std::vector<SampledPair> sampled = sampled_pairs(character, joints, asset, pairs);
  const SkinGaps skin_gaps(character.skin, binding);
  std::vector<double> gaps(pairs.size(), -1);  // each found once
  const auto is_rest_pair = [&](std::size_t i, double BoundSphere::*detect) {
    if (kNear * rest_distance(binding, pairs[i]) >= radius_sum(binding, pairs[i], detect)) return false;
    if (gaps[i] < 0) gaps[i] = skin_gaps.between(pairs[i].a, pairs[i].b);
    return gaps[i] >= kClose * regions.frame.height;
  };
  std::vector<bool> before;
  std::vector<double> sampled_radii;
  for (std::size_t i = 0; i < pairs.size(); ++i) before.push_back(is_rest_pair(i, &BoundSphere::detect_radius));
  for (const BoundSphere& sphere : binding.spheres) sampled_radii.push_back(sphere.detect_radius);
  if (regions.follow_bones()) {
    const std::vector<double> factors = grow_radii(sampled, before, binding.spheres.size());
    for (std::size_t s = 0; s < factors.size(); ++s) binding.spheres[s].detect_radius *= factors[s];
  }

  const auto rest_pairs = [&](double BoundSphere::*detect) {
    const auto scale_of = [&](std::uint32_t s) {
      const BoundSphere& sphere = binding.spheres[s];
      return (detect ? sphere.*detect : sphere.rest.radius) / sampled_radii[s];
    };
    std::vector<BoundPair> out;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      if (!is_rest_pair(i, detect)) continue;
      const auto [a, b] = pairs[i];
      const double at_rest =
          (rest_distance(binding, pairs[i]) - kGapShare * gaps[i]) / radius_sum(binding, pairs[i], detect);
      const double scale = std::max({0.0, at_rest, best_reach(sampled[i], scale_of(a), scale_of(b))});
      if (scale < 1) out.push_back({a, b, scale});
    }
    return out;
  };
  binding.rest_fit = rest_pairs(nullptr);
  binding.rest_detect = rest_pairs(&BoundSphere::detect_radius);
}

}  // namespace spherechain::baker
