// SPDX-License-Identifier: MIT
// The paper's threads, one after the other, against PlainDetection.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include "paper_threads.h"
#include "tiny_asset.h"

namespace spherechain::test {
namespace {

using cuda_paper::PairList;
using cuda_paper::Scene;
using cuda_paper::Tables;

bool by_chain(const ChainPair& l, const ChainPair& r) {
  return l.chain != r.chain ? l.chain < r.chain : l.pair < r.pair;
}

bool same(const std::vector<ChainPair>& l, const std::vector<ChainPair>& r) {
  return std::equal(l.begin(), l.end(), r.begin(), r.end(),
                    [](const ChainPair& p, const ChainPair& q) { return p.chain == q.chain && p.pair == q.pair; });
}

// Every thread of a grid of whole blocks, which has more than there is work for, in any order.
void launch(std::uint32_t threads, std::mt19937& random, const std::function<void(std::uint32_t)>& thread) {
  constexpr std::uint32_t kBlock = 64;
  std::vector<std::uint32_t> order((threads + kBlock - 1) / kBlock * kBlock + kBlock);
  std::iota(order.begin(), order.end(), 0U);
  std::shuffle(order.begin(), order.end(), random);
  for (const std::uint32_t i : order) {
    thread(i);
  }
}

struct Found {
  std::vector<ChainPair> m2_sphere, m1_chain, m1_sphere;
};

// Sorted.
Found run_threads(const Tables& tables, const std::vector<Sphere>& spheres) {
  const Scene scene = tables.scene(spheres.data());
  std::mt19937 random(5);
  const auto collect = [&](const std::function<void(const PairList&)>& grid) {
    std::vector<ChainPair> entries(spheres.size() * spheres.size() * (scene.chain_count + 1));
    std::uint32_t count = 0;
    grid({entries.data(), static_cast<std::uint32_t>(entries.size()), &count});
    REQUIRE(count <= entries.size());
    entries.resize(count);
    std::sort(entries.begin(), entries.end(), by_chain);
    return entries;
  };
  return {collect([&](const PairList& list) {
            launch(scene.sphere_count, random, [&](std::uint32_t i) { test_sphere(scene, i, list); });
          }),
          collect([&](const PairList& list) {
            launch(scene.chain_count, random, [&](std::uint32_t chain) { test_chain(scene, chain, list); });
          }),
          collect([&](const PairList& list) {
            for (std::uint32_t chain = 0; chain < scene.chain_count + 2; ++chain) {
              launch(tables.longest_chain, random, [&](std::uint32_t place) { test_place(scene, chain, place, list); });
            }
          })};
}

// How many overlaps M1 has.
std::size_t check_like_plain(const AssetView& asset, const std::vector<Sphere>& spheres, Radius radius) {
  const Found found = run_threads(Tables(asset, radius), spheres);
  const PlainDetection plain(asset, radius);
  std::vector<ChainPair> m1 = plain.chains(spheres.data()).chain_pairs, m2;
  for (const Pair& pair : plain.all_pairs(spheres.data()).pairs) {
    m2.push_back({0, pair});
  }
  std::sort(m1.begin(), m1.end(), by_chain);
  CHECK(same(found.m2_sphere, m2));
  CHECK(same(found.m1_chain, m1));
  CHECK(same(found.m1_sphere, m1));
  return m1.size();
}

constexpr Radius kRadii[] = {SC_RADIUS_FIT, SC_RADIUS_DETECT};

}  // namespace

TEST_CASE("the paper's threads find the pairs of M1 and M2, in every chain that holds them") {
  std::mt19937 random(11);
  std::size_t overlaps = 0;
  for (const unsigned n : {1U, 2U, 3U, 17U, 50U, 64U, 65U, 84U, 128U, 129U, 200U}) {
    CAPTURE(n);
    const OpenedAsset opened(random_asset(n, n).parts);
    REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
    for (const Radius radius : kRadii) {
      for (int draw = 0; draw < 4; ++draw) {
        overlaps += check_like_plain(opened.view(), random_spheres(n, random), radius);
      }
    }
  }
  CHECK(overlaps > 10000);
}

TEST_CASE("spheres that are not finite, or too large to square, touch nothing in the paper's threads either") {
  constexpr std::size_t kCount = 40;
  const OpenedAsset opened(random_asset(kCount, 3).parts);
  REQUIRE(opened.status == SC_OK);
  std::mt19937 random(13);
  for (const float odd : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity(), 1e30F, -1.0F}) {
    std::vector<Sphere> spheres = random_spheres(kCount, random);
    for (std::size_t i = 0; i < kCount; i += 3) {
      (i % 2 == 0 ? spheres[i].radius : spheres[i].y) = odd;
    }
    check_like_plain(opened.view(), spheres, SC_RADIUS_FIT);
  }
}

// A sum in another order, or a multiply-add, decides one in some hundred of these otherwise.
TEST_CASE("where the last bit decides, the paper's threads decide as plain loops do") {
  AssetParts parts = random_asset(2, 1).parts;
  parts.ignored.assign(parts.ignored.size(), 0);
  parts.rest_fit.clear();
  parts.chains.assign(1, {"all", {0}, {0, 1}});
  const OpenedAsset opened(parts);
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  std::mt19937 random(19);
  for (int draw = 0; draw < 2000; ++draw) {
    const auto place = [&] { return Sphere{uniform(random, 0, 1), uniform(random, 0, 1), uniform(random, 0, 1), 0}; };
    const Sphere p = place();
    Sphere q = place();
    const float dx = p.x - q.x, dy = p.y - q.y, dz = p.z - q.z;
    q.radius = std::sqrt((dx * dx + dy * dy) + dz * dz);
    const float next = std::nextafter(q.radius, 2.0F);
    for (const float radius : {q.radius, next}) {
      q.radius = radius;
      check_like_plain(opened.view(), {p, q}, SC_RADIUS_FIT);
    }
  }
}

TEST_CASE("a list that is too short keeps what fits and counts on") {
  const OpenedAsset opened(random_asset(60, 7).parts);
  REQUIRE(opened.status == SC_OK);
  std::mt19937 random(17);
  const std::vector<Sphere> spheres = random_spheres(60, random);
  const Tables tables(opened.view(), SC_RADIUS_DETECT);
  const Scene scene = tables.scene(spheres.data());
  const std::size_t all = run_threads(tables, spheres).m2_sphere.size();
  REQUIRE(all > 10);
  std::vector<ChainPair> entries(10, ChainPair{99, {99, 99}});
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < scene.sphere_count; ++i) {
    test_sphere(scene, i, {entries.data(), 9, &count});
  }
  CHECK(count == all);
  CHECK(entries[8].chain == 0);
  CHECK(entries[9].chain == 99);
}

}  // namespace spherechain::test
