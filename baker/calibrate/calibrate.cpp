// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/calibrate/calibrate.h"

#include <algorithm>
#include <optional>

#include "baker/calibrate/random_poses.h"
#include "baker/calibrate/reach.h"
#include "baker/calibrate/samples.h"
#include "baker/calibrate/skin_gap.h"

namespace spherechain::baker {
namespace {

constexpr double kClose = 0.003;      // of the height: skins that are this near at rest touch in most poses,
constexpr double kCloseReach = 1.03;  // and are reported up to this part of the spheres' distance at rest
constexpr double kGapShare = 0.6;     // of another gap must close
constexpr double kNear = 0.9;         // spheres nearly touch where this part of their distance is within their radii
constexpr double kListed = 0.01;      // of the poses: what a pair's own distance saves in false alarms, at least
constexpr double kAlways = 0.8;       // of the poses: what touches in so many is no alarm
constexpr std::size_t kElements = 30'000'000;  // triangles, or nodes and bones, of all poses together, at most

std::vector<Pair> tested_pairs(const Binding& binding) {
  std::vector<Pair> out;
  for (std::uint32_t a = 0; a < binding.spheres.size(); ++a) {
    for (std::uint32_t b = a + 1; b < binding.spheres.size(); ++b) {
      if (!std::binary_search(binding.ignored.begin(), binding.ignored.end(), std::pair(a, b))) out.push_back({a, b});
    }
  }
  return out;
}

int pose_count(const Character& character) {
  const std::size_t of_rig = character.rig.nodes.size() + character.rig.bones.size();
  const std::size_t fitting = kElements / std::max(character.skin.triangles.size(), of_rig) + 1;
  return static_cast<int>(std::min<std::size_t>(kCalibrationPoses, fitting));
}

std::vector<SampledPair> sampled_pairs(const Character& character, const std::vector<Joint>& joints,
                                       const std::vector<std::uint8_t>& asset, const std::vector<Pair>& pairs) {
  const RandomPoses poses(character, joints);
  if (poses.any() && !pairs.empty()) return sample_pairs(asset, pairs, poses, pose_count(character));
  std::vector<SampledPair> out;
  for (const Pair& pair : pairs) out.push_back({pair, {}});
  return out;
}

// A pair whose skins touch in nearly every pose raises no alarm.
void forget_what_always_touches(std::vector<SampledPair>& pairs, int poses) {
  for (SampledPair& pair : pairs) {
    const auto touches = std::ranges::count_if(pair.samples, &PairSample::touch);
    if (static_cast<double>(touches) < kAlways * poses) continue;
    for (PairSample& sample : pair.samples) sample.touch = false;
    pair.always_touches = true;
  }
}

double rest_distance(const Binding& binding, const Pair& pair) {
  return (binding.spheres[pair.a].rest.center - binding.spheres[pair.b].rest.center).norm();
}

// The fit or the detect radii of all spheres at rest.
std::vector<double> radii_of(const Binding& binding, bool detect) {
  std::vector<double> out;
  for (const BoundSphere& sphere : binding.spheres) out.push_back(detect ? sphere.detect_radius : sphere.rest.radius);
  return out;
}

}  // namespace

void calibrate(const Character& character, const Regions& regions, const std::vector<Joint>& joints,
               const std::vector<std::uint8_t>& draft, Binding& binding) {
  const std::vector<Pair> pairs = tested_pairs(binding);
  std::vector<SampledPair> sampled = sampled_pairs(character, joints, draft, pairs);
  forget_what_always_touches(sampled, pose_count(character));
  const std::vector<double> sampled_radii = radii_of(binding, true);
  const auto sum_of = [&](const Pair& pair, const std::vector<double>& radii) { return radii[pair.a] + radii[pair.b]; };

  const SkinGaps skin_gaps(character.skin, binding);
  std::vector<std::optional<double>> at_rest;
  for (const Pair& pair : pairs) {
    const double distance = rest_distance(binding, pair), sum = sum_of(pair, sampled_radii);
    at_rest.emplace_back();
    if (kNear * distance >= sum || sampled[at_rest.size() - 1].always_touches) continue;
    const double gap = skin_gaps.between(pair.a, pair.b);
    at_rest.back() = (gap < kClose * regions.frame.height ? kCloseReach * distance : distance - kGapShare * gap) / sum;
  }
  const std::vector<double> reaches = best_reaches(sampled, at_rest, binding.spheres.size());
  const bool any = std::any_of(sampled.begin(), sampled.end(), [](const auto& pair) { return !pair.samples.empty(); });
  if (any && regions.is_tree()) {
    std::vector<double> least = radii_of(binding, false);
    for (std::size_t s = 0; s < least.size(); ++s) least[s] /= sampled_radii[s];
    const std::vector<double> factors = radius_factors(sampled, reaches, sampled_radii, least);
    for (std::size_t s = 0; s < factors.size(); ++s) {
      if (!binding.spheres[s].keeps_detect_radius) binding.spheres[s].detect_radius *= factors[s];
    }
  }

  const auto listed = static_cast<std::size_t>(kListed * pose_count(character));
  const auto rest_pairs = [&](const std::vector<double>& radii) {
    const auto factor = [&](std::uint32_t s) { return radii[s] / sampled_radii[s]; };
    std::vector<BoundPair> out;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const auto [a, b] = pairs[i];
      const auto scale = static_cast<float>(reaches[i] * sum_of(pairs[i], sampled_radii) / sum_of(pairs[i], radii));
      if (scale >= 1) continue;
      const double part = rest_distance(binding, pairs[i]) / sum_of(pairs[i], radii);
      const bool at_rest = part < 1 && part >= scale;  // else it would be reported there
      const std::size_t saved = false_alarms_beyond(sampled[i], reaches[i], factor(a), factor(b));
      if (at_rest || saved > listed) out.push_back({a, b, scale});
    }
    return out;
  };
  binding.rest_fit = rest_pairs(radii_of(binding, false));
  binding.rest_detect = rest_pairs(radii_of(binding, true));
}

}  // namespace spherechain::baker
