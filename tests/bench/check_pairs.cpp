// SPDX-License-Identifier: GPL-3.0-or-later
#include "check_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "studies/plain_detection.h"

namespace spherechain::bench {
namespace {

constexpr double kTie = 1e-5;

// How far from touching, as a fraction of the distance at which they do.
double gap(const Sphere* spheres, Pair pair) {
  const Sphere &p = spheres[pair.a], &q = spheres[pair.b];
  const double s = static_cast<double>(p.radius) + q.radius;
  return std::hypot(static_cast<double>(p.x) - q.x, static_cast<double>(p.y) - q.y, static_cast<double>(p.z) - q.z) /
             s -
         1;
}

}  // namespace

Agreement check_pairs(const PosedCharacter& character, PairFinder& finder) {
  const AssetView& asset = character.view();
  const PlainDetection plain(asset, SC_RADIUS_DETECT);
  Agreement result;
  for (std::size_t pose = 0; pose < character.spheres.size() && result.difference.empty(); ++pose) {
    const Sphere* spheres = character.spheres[pose].data();
    const std::vector<Pair> expected = plain.all_pairs(spheres).pairs;
    finder.find(spheres);
    std::vector<Pair> found = finder.pairs();
    result.pairs += expected.size();
    result.candidates += found.size();
    const auto differ = [&](const char* how, Pair pair) {
      result.difference = fmt::format("pose {}: spheres {} and {} {}", pose, pair.a, pair.b, how);
    };
    std::sort(found.begin(), found.end());
    if (const auto twice = std::adjacent_find(found.begin(), found.end()); twice != found.end()) {
      differ("are found twice", *twice);
    }
    for (const Pair& pair : expected) {
      if (std::binary_search(found.begin(), found.end(), pair)) {
        continue;
      }
      const bool is_tie = finder.found == Found::kTouching && std::abs(gap(spheres, pair)) < kTie;
      result.ties += is_tie ? 1 : 0;
      if (!is_tie) {
        differ("are missing", pair);
      }
    }
    for (const Pair& pair : found) {
      if (finder.found == Found::kExactly && !std::binary_search(expected.begin(), expected.end(), pair)) {
        differ("do not touch", pair);
      } else if (finder.found == Found::kTouching && gap(spheres, pair) > kTie) {
        differ("do not touch", pair);
      } else if (test_bit(asset.ignored(), ignored_bit(pair.a, pair.b))) {
        differ("are ignored", pair);
      }
    }
  }
  return result;
}

}  // namespace spherechain::bench
