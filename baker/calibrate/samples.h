// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/calibrate/random_poses.h"
#include "spherechain/types.h"

namespace spherechain::baker {

// Two spheres in one pose.
struct PairSample {
  float distance;
  float radius_a, radius_b;  // the detect radii
  bool touch;                // whether their skins intersect
  bool expected;             // whether the pose is a moment of a clip
};

// Poses with two spheres farther apart than this multiple of their radii's sum are not sampled.
inline constexpr double kSampledReach = 2;

struct SampledPair {
  Pair spheres;
  std::vector<PairSample> samples;
  bool always_touches = false;  // in most poses: its samples say that it touches in none
};

// An asset in `count` random poses: what the runtime says about these pairs, bones to spheres and to exact contacts.
// `pairs` are sorted. The same numbers on every machine.
std::vector<SampledPair> sample_pairs(const std::vector<std::uint8_t>& asset, const std::vector<Pair>& pairs,
                                      const RandomPoses& poses, int count);

}  // namespace spherechain::baker
