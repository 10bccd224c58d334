// SPDX-License-Identifier: MIT
// Detection looks for candidates with a margin for its rounding. Here pairs are where that matters: a few roundings
// from touching, of spheres large and small, near the origin and far from it, and so far that squares are infinite.
#include <doctest/doctest.h>

#include <cmath>
#include <set>

#include "crowds.h"
#include "jobs.h"
#include "tiny_asset.h"

namespace spherechain::test {
namespace {

// The pairs that a crowd of this one instance finds.
std::vector<Pair> in_crowd(const Asset& asset, const std::vector<Sphere>& spheres, Target target) {
  CrowdBuffers buffers(asset, 1, 1);
  std::vector<CrowdPair> found(spheres.size() * spheres.size());
  buffers.job.spheres = spheres.data();
  buffers.job.target = target;
  buffers.job.pairs = found.data();
  buffers.job.pair_capacity = found.size();
  REQUIRE(buffers.job.run() == SC_OK);
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < buffers.job.pair_count; ++i) pairs.push_back(found[i].pair);
  return pairs;
}

float squared(float v) { return v * v; }

bool touch(const Sphere& p, const Sphere& q) {
  const float d2 = (squared(p.x - q.x) + squared(p.y - q.y)) + squared(p.z - q.z);
  return d2 < squared(p.radius + q.radius);
}

// Couples of spheres within about `roundings` roundings of touching; the couples strewn over a box of 20 radii.
std::vector<Sphere> couples(std::size_t count, float scale, float offset, float roundings, std::mt19937& random) {
  std::vector<Sphere> out;
  while (out.size() < count) {
    const auto coordinate = [&] { return scale * (offset + uniform(random, -10, 10)); };
    const Sphere p{coordinate(), coordinate(), coordinate(), scale * uniform(random, 0.1F, 2)};
    const float radius = scale * uniform(random, 0.1F, 2);
    const float x = uniform(random, -1, 1), y = uniform(random, -1, 1), z = uniform(random, -1, 1);
    const float away = 1 + roundings * uniform(random, -1, 1) * 0x1p-24F;
    const float step = (p.radius + radius) / std::sqrt(x * x + y * y + z * z) * away;
    out.push_back(p);
    out.push_back({p.x + step * x, p.y + step * y, p.z + step * z, radius});
  }
  out.resize(count);
  return out;
}

}  // namespace

TEST_CASE("pairs a few roundings from touching are decided by the formula alone, at any scale and place") {
  std::mt19937 random(7);
  std::size_t reported = 0, close = 0;
  for (const std::size_t n : {2U, 30U, 128U, 150U}) {
    TinyAsset tiny = random_asset(n, static_cast<unsigned>(n));
    tiny.parts.rest_fit.clear();
    tiny.parts.rest_detect.clear();
    const OpenedAsset opened(tiny.parts);
    const std::set<Pair> ignored(tiny.ignored_pairs.begin(), tiny.ignored_pairs.end());
    for (const float scale : {1e-22F, 1e-18F, 1e-3F, 1.0F, 1e4F, 1e15F, 1e17F, 3e17F, 5e17F, 1e18F}) {
      for (const float offset : {0.0F, 3.0F, 1000.0F}) {
        CAPTURE(n);
        CAPTURE(scale);
        CAPTURE(offset);
        const std::vector<Sphere> spheres = couples(n, scale, offset, 3, random);
        std::vector<Pair> expected;
        for (std::uint32_t a = 0; a < n; ++a) {
          for (std::uint32_t b = a + 1; b < n; ++b) {
            if (touch(spheres[a], spheres[b]) && ignored.count({a, b}) == 0) {
              expected.push_back({a, b});
              close += a % 2 == 0 && b == a + 1 ? 1 : 0;
            }
          }
        }
        reported += expected.size();
        for (const Target target : supported_targets()) {
          INFO(std::string(sc_target_name(target)));
          CHECK(detect(opened.asset, spheres, SC_RADIUS_DETECT, target).pairs == expected);
          CHECK(in_crowd(opened.asset, spheres, target) == expected);
        }
      }
    }
  }
  CHECK(close > 500);  // of the couples, about half
  CHECK(reported > close);
}

TEST_CASE("spheres touch as well where the squares of their coordinates are infinite") {
  TinyAsset tiny = random_asset(40, 1);
  tiny.parts.ignored.assign(tiny.parts.ignored.size(), 0);
  tiny.parts.rest_detect.clear();
  const OpenedAsset opened(tiny.parts);
  for (const float far : {1e18F, 1e19F, 1.8e19F, 1.9e19F, 1e20F, 1e30F, 3e38F}) {
    std::vector<Sphere> spheres(40, {0, 0, 0, 1});
    std::vector<Pair> expected;
    for (std::uint32_t i = 0; i < 20; ++i) {
      // Two at each place along an axis, far from all others.
      const float at = far / static_cast<float>(i % 7 + 1), sign = i % 2 == 0 ? 1.0F : -1.0F;
      Sphere sphere{0, 0, 0, 1};
      (i % 3 == 0 ? sphere.x : i % 3 == 1 ? sphere.y : sphere.z) = i == 0 ? 0 : sign * at;
      spheres[2 * i] = spheres[2 * i + 1] = sphere;
    }
    for (std::uint32_t a = 0; a < 40; ++a) {
      for (std::uint32_t b = a + 1; b < 40; ++b) {
        if (touch(spheres[a], spheres[b])) expected.push_back({a, b});
      }
    }
    REQUIRE(expected.size() >= 20);
    for (const Target target : supported_targets()) {
      CAPTURE(far);
      INFO(std::string(sc_target_name(target)));
      CHECK(detect(opened.asset, spheres, SC_RADIUS_DETECT, target).pairs == expected);
      CHECK(in_crowd(opened.asset, spheres, target) == expected);
    }
  }
}

}  // namespace spherechain::test
