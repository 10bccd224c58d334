// SPDX-License-Identifier: GPL-3.0-or-later
#include "check_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace spherechain::bench {
namespace {

constexpr double kTie = 1e-5;

float squared(float v) { return v * v; }

// The loop all are compared with.
class Rule {
 public:
  explicit Rule(const Asset& asset) : asset_(asset) {
    for (const NearPair& near : asset.near_pairs(RadiusKind::kDetect)) {
      reach_[{near.a, near.b}] = near.reach;
    }
    for (std::size_t c = 0; c < asset.chain_count(); ++c) {
      for (const std::uint32_t a : asset.chain(c).spheres) {
        for (const std::uint32_t b : asset.chain(c).spheres) {
          in_chains_.insert({a, b});
        }
      }
    }
  }

  bool is_ignored(Pair pair) const {
    const std::size_t bit = std::size_t{pair.b} * (pair.b - 1) / 2 + pair.a;
    return ((asset_.ignored()[bit / 64] >> (bit % 64)) & 1U) != 0;
  }

  bool reports(const Sphere* spheres, Pair pair) const {
    const Sphere &p = spheres[pair.a], &q = spheres[pair.b];
    const float d2 = (squared(p.x - q.x) + squared(p.y - q.y)) + squared(p.z - q.z);
    const float s = p.radius + q.radius;
    const auto near = reach_.find(pair);
    return !is_ignored(pair) && d2 < squared(s) && (near == reach_.end() || d2 < squared(near->second * s));
  }

  std::vector<Pair> all(const Sphere* spheres, bool in_chains) const {
    std::vector<Pair> out;
    for (std::uint32_t a = 0; a < asset_.spheres().size; ++a) {
      for (std::uint32_t b = a + 1; b < asset_.spheres().size; ++b) {
        if (reports(spheres, {a, b}) && (!in_chains || in_chains_.count({a, b}) > 0)) {
          out.push_back({a, b});
        }
      }
    }
    return out;
  }

 private:
  const Asset& asset_;
  std::map<Pair, float> reach_;
  std::set<Pair> in_chains_;
};

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
  const Rule rule(character.asset);
  Agreement result;
  for (std::size_t pose = 0; pose < character.spheres.size() && result.difference.empty(); ++pose) {
    const Sphere* spheres = character.spheres[pose].data();
    const std::vector<Pair> expected = rule.all(spheres, finder.found == Found::kInChains);
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
      if ((finder.found == Found::kExactly || finder.found == Found::kInChains) && !rule.reports(spheres, pair)) {
        differ("do not touch", pair);
      } else if (finder.found == Found::kTouching && gap(spheres, pair) > kTie) {
        differ("do not touch", pair);
      } else if (rule.is_ignored(pair)) {
        differ("are ignored", pair);
      }
    }
  }
  return result;
}

}  // namespace spherechain::bench
