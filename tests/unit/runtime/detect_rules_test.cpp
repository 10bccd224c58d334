// SPDX-License-Identifier: MIT
// The rules for one pair, and the buffers.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "exact_fma.h"
#include "jobs.h"
#include "studies/plain_detection.h"
#include "tiny_asset.h"

namespace spherechain::test {
namespace {

// n spheres, nothing ignored, no rest pairs.
AssetParts plain_asset(std::uint32_t n) {
  AssetParts parts = random_asset(n, 1).parts;
  parts.ignored.assign(parts.ignored.size(), 0);
  parts.rest_fit.clear();
  parts.rest_detect.clear();
  return parts;
}

std::vector<Pair> pairs_of(const AssetParts& parts, const std::vector<Sphere>& spheres,
                           Radius kind = SC_RADIUS_DETECT) {
  const OpenedAsset opened(parts);
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  const Detected found = detect(opened.asset, spheres, kind);
  CHECK(found.pairs == PlainDetection(opened.view(), kind).all_pairs(spheres.data()).pairs);
  return found.pairs;
}

}  // namespace

TEST_CASE("spheres overlap where they share a point inside both, not where they only touch") {
  const AssetParts parts = plain_asset(2);
  CHECK(pairs_of(parts, {{0, 0, 0, 1}, {0, 3, 0, 2}}).empty());
  CHECK(pairs_of(parts, {{0, 0, 0, 1}, {0, std::nextafter(3.0F, 0.0F), 0, 2}}).size() == 1);
  CHECK(pairs_of(parts, {{0, 0, 0, 0}, {0, 0, 0, 0}}).empty());
  CHECK(pairs_of(parts, {{1, 2, 3, 0.5F}, {1, 2, 3, 0}}).size() == 1);
}

TEST_CASE("the squared distance is summed in the order the header gives, where the last bit decides") {
  const OpenedAsset opened(plain_asset(2));
  std::mt19937 random(3);
  int other_order_differs = 0, fused_differs = 0;
  for (int i = 0; i < 5000; ++i) {
    const Sphere p{uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1), 0.0F};
    Sphere q{uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1), 0.0F};
    const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z;
    const float d2 = (dx * dx + dy * dy) + dz * dz;
    q.radius = std::sqrt(d2);  // they touch, as nearly as a float can say
    const float reach = q.radius * q.radius;
    const bool overlaps = !detect(opened.asset, {p, q}, SC_RADIUS_FIT).pairs.empty();
    CHECK(overlaps == (d2 < reach));
    other_order_differs += overlaps != (dx * dx + (dy * dy + dz * dz) < reach);
    fused_differs += overlaps != (exact_fma(dz, dz, exact_fma(dy, dy, dx * dx)) < reach);
  }
  CHECK(other_order_differs > 100);
  CHECK(fused_differs > 100);
}

TEST_CASE("an ignored pair is neither tested nor reported") {
  AssetParts parts = plain_asset(3);
  parts.ignored[0] = 1U << 1;  // bit b(b-1)/2 + a: a = 0, b = 2
  const std::vector<Sphere> heap(3, {0, 0, 0, 1});
  CHECK(pairs_of(parts, heap) == std::vector<Pair>{{0, 1}, {1, 2}});
}

TEST_CASE("a rest pair is reported only where it is closer than its scale, which each radius has of its own") {
  AssetParts parts = plain_asset(2);
  parts.rest_fit = {{0, 1, 0.75F}};
  parts.rest_detect = {{0, 1, 0.5F}};
  const auto apart = [](float distance) { return std::vector<Sphere>{{0, 0, 0, 1}, {distance, 0, 0, 1}}; };
  CHECK(pairs_of(parts, apart(1.6F), SC_RADIUS_FIT).empty());
  CHECK(pairs_of(parts, apart(1.5F), SC_RADIUS_FIT).empty());
  CHECK(pairs_of(parts, apart(1.4F), SC_RADIUS_FIT).size() == 1);
  CHECK(pairs_of(parts, apart(1.4F), SC_RADIUS_DETECT).empty());
  CHECK(pairs_of(parts, apart(0.9F), SC_RADIUS_DETECT).size() == 1);
  parts.rest_detect[0].rest_scale = 0;
  CHECK(pairs_of(parts, apart(0.0F), SC_RADIUS_DETECT).empty());
  parts.rest_detect[0].rest_scale = 0.75F;
  parts.ignored[0] = 1;
  CHECK(pairs_of(parts, apart(0.0F), SC_RADIUS_DETECT).empty());
}

TEST_CASE("a scale just below 1 is decided by the formula alone, at the distances where the full sum flips") {
  AssetParts parts = plain_asset(2);
  const float scale = std::nextafter(1.0F, 0.0F);
  parts.rest_detect = {{0, 1, scale}};
  const OpenedAsset opened(parts);
  std::mt19937 random(2);
  int reported = 0;
  for (int i = 0; i < 1000; ++i) {
    const float p = uniform(random, 0, 1), q = uniform(random, 0, 1);
    for (const float d :
         {p + q, std::nextafter(p + q, 0.0F), std::nextafter(p + q, 4.0F), std::nextafter(scale * (p + q), 0.0F)}) {
      const std::vector<Sphere> spheres{{0, 0, 0, p}, {0, d, 0, q}};
      const float s = scale * (p + q);
      const bool expected = d * d < s * s;  // the full sum is not asked
      CHECK(detect(opened.asset, spheres, SC_RADIUS_DETECT).pairs.size() == (expected ? 1 : 0));
      reported += expected ? 1 : 0;
    }
  }
  CHECK(reported > 0);
}

TEST_CASE("a sphere that is not finite touches nothing") {
  const AssetParts parts = plain_asset(2);
  const std::vector<Sphere> odd = {{kNan, 0, 0, 1},       {0, kInfinity, 0, 1}, {0, 0, -kInfinity, 1},
                                   {0, 0, 0, kNan},       {0, 0, 0, kInfinity}, {kInfinity, 0, 0, kInfinity},
                                   {0, 0, 0, -kInfinity}, {0, 0, 0, 3e38F},     {3e38F, 0, 0, 1}};
  for (const Sphere& sphere : odd) {
    CAPTURE(sphere.x);
    CAPTURE(sphere.radius);
    CHECK(pairs_of(parts, {sphere, {0, 0, 0, 2}}).empty());
    for (const Sphere& other : odd) {
      // Two of the last kind are finite and in one place: the only ones to overlap.
      const bool overlaps = sphere.x == 3e38F && other.x == 3e38F;
      CHECK(pairs_of(parts, {sphere, other}).size() == (overlaps ? 1 : 0));
    }
  }
}

TEST_CASE("an overflow says how many pairs there are and writes the first ones, of one tile and of several") {
  for (const std::uint32_t n : {40U, 128U, 300U}) {
    const OpenedAsset opened(plain_asset(n));
    const std::vector<Sphere> heap(n, {0, 0, 0, 1});
    const std::vector<Pair> all = detect(opened.asset, heap, SC_RADIUS_DETECT).pairs;
    REQUIRE(all.size() == n * (n - 1) / 2);
    for (const std::size_t capacity : {std::size_t{1}, std::size_t{129}, all.size() - 1}) {
      std::vector<Pair> pairs(capacity + 1, {77, 77});
      DetectJob job;
      job.asset = &opened.asset;
      job.spheres = heap.data();
      job.sphere_count = heap.size();
      job.pairs = pairs.data();
      job.pair_capacity = capacity;
      CHECK(job.run() == sc_status{SC_OVERFLOW, SC_FIELD_PAIRS});
      CHECK(job.pair_count == all.size());
      CHECK(std::equal(pairs.begin(), pairs.end() - 1, all.begin()));
      CHECK(pairs.back() == Pair{77, 77});
    }
  }
}

TEST_CASE("rest pairs may be many") {
  std::mt19937 random(5);
  for (const std::uint32_t n : {23U, 24U, 120U, 150U}) {
    AssetParts parts = plain_asset(n);
    for (std::uint32_t a = 0; a < n; ++a) {
      for (std::uint32_t b = a + 1; b < n; ++b) {
        if ((a + b) % 7 != 0) parts.rest_detect.push_back({a, b, uniform(random, 0.3F, 1.0F)});
      }
    }
    CHECK(!pairs_of(parts, random_spheres(n, random)).empty());
  }
}

}  // namespace spherechain::test
