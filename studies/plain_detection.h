// SPDX-License-Identifier: MIT
// The paper's two methods in plain loops: M1 chain by chain, M2 over all pairs. For the paper's experiments, and the
// reference of tests; the product's detection is sc_detect(). Not part of the library: it allocates.
#pragma once

#include <algorithm>
#include <cfloat>
#include <cstddef>
#include <vector>

#include "runtime/src/asset/asset_view.h"
#include "runtime/src/base/pair_bits.h"

namespace spherechain {

// An overlap as the paper counts it: a pair shows up once for every chain that holds both spheres, in the order of the
// chain: its first sphere with all after it, its second ...
struct ChainPair {
  std::uint32_t chain;
  Pair pair;
};

struct PlainResult {
  std::size_t test_count = 0;          // pairs that are not ignored; of chains: with repeats
  std::vector<Pair> pairs;             // sorted, each once
  std::vector<ChainPair> chain_pairs;  // of chains: with repeats
};

// docs/arithmetic.md, "Detection".
inline bool spheres_touch(const Sphere& p, const Sphere& q, float rest_scale) {
  const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z;
  const float d2 = (dx * dx + dy * dy) + dz * dz, s = p.radius + q.radius, t = rest_scale * s;
  return d2 < s * s && s * s <= FLT_MAX && (rest_scale == 1 || d2 < t * t);
}

class PlainDetection {
 public:
  PlainDetection(const AssetView& asset, Radius radius) : asset_(asset), rest_pairs_(asset.rest_pairs(radius)) {}

  PlainResult all_pairs(const Sphere* spheres) const {
    PlainResult out;
    const auto count = static_cast<std::uint32_t>(asset_.spheres().size);
    for (std::uint32_t a = 0; a < count; ++a) {
      for (std::uint32_t b = a + 1; b < count; ++b) {
        if (test(spheres, {a, b}, out)) {
          out.pairs.push_back({a, b});
        }
      }
    }
    return out;
  }

  PlainResult chains(const Sphere* spheres) const {
    PlainResult out;
    for (std::uint32_t c = 0; c < asset_.chain_count(); ++c) {
      const Span<const std::uint32_t> members = asset_.chain(c).spheres;
      for (std::size_t i = 0; i < members.size; ++i) {
        for (std::size_t k = i + 1; k < members.size; ++k) {
          const Pair pair{std::min(members[i], members[k]), std::max(members[i], members[k])};
          if (test(spheres, pair, out)) {
            out.chain_pairs.push_back({c, pair});
            out.pairs.push_back(pair);
          }
        }
      }
    }
    std::sort(out.pairs.begin(), out.pairs.end());
    out.pairs.erase(std::unique(out.pairs.begin(), out.pairs.end()), out.pairs.end());
    return out;
  }

 private:
  bool test(const Sphere* spheres, Pair pair, PlainResult& out) const {
    if (test_bit(asset_.ignored(), ignored_bit(pair.a, pair.b))) {
      return false;
    }
    ++out.test_count;
    const Sphere &p = spheres[pair.a], &q = spheres[pair.b];
    return spheres_touch(p, q, 1) && spheres_touch(p, q, rest_scale_of(pair));  // few pairs are looked up
  }
  float rest_scale_of(Pair pair) const {
    const auto before = [](const RestPair& l, Pair r) { return Pair{l.a, l.b} < r; };
    const RestPair* const found = std::lower_bound(rest_pairs_.begin(), rest_pairs_.end(), pair, before);
    return found != rest_pairs_.end() && found->a == pair.a && found->b == pair.b ? found->rest_scale : 1;
  }

  const AssetView& asset_;
  Span<const RestPair> rest_pairs_;
};

}  // namespace spherechain
