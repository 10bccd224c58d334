// SPDX-License-Identifier: MIT
#include "split_spheres.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "studies/plain_detection.h"
#include "tiny_asset.h"

namespace spherechain::bench {
namespace {

constexpr std::uint32_t kParts = 7;
constexpr std::size_t kSpheres = 30;

bool is_ignored(const AssetView& asset, std::size_t a, std::size_t b) {
  return test_bit(asset.ignored(), ignored_bit(a, b));
}

// -1 where it is no rest pair.
float rest_scale_of(const AssetView& asset, const Pair& pair) {
  for (const RestPair& rest : asset.rest_pairs(SC_RADIUS_FIT)) {
    if (Pair{rest.a, rest.b} == pair) {
      return rest.rest_scale;
    }
  }
  return -1;
}

}  // namespace

TEST_CASE("a sphere's parts lie inside it, are alike, and have its volume together") {
  const test::OpenedAsset whole(test::random_asset(kSpheres, 1).parts);
  REQUIRE(whole.status == SC_OK);
  std::mt19937 random(2);
  std::vector<Sphere> spheres = test::random_spheres(kSpheres, random);
  for (Sphere& sphere : spheres) {
    sphere.radius += 0.1F;  // some are points
  }
  for (const std::uint32_t parts : {2U, 7U, 20U, 200U}) {
    const std::vector<Sphere> split = SplitAsset(whole.asset, parts).split(spheres);
    REQUIRE(split.size() == kSpheres * parts);
    for (std::size_t i = 0; i < split.size(); ++i) {
      const Sphere &s = spheres[i / parts], &p = split[i];
      CHECK(std::hypot(p.x - s.x, p.y - s.y, p.z - s.z) + p.radius <= s.radius * 1.0001F);
      CHECK(std::pow(p.radius / s.radius, 3) * static_cast<float>(parts) == doctest::Approx(1).epsilon(1e-4));
      if (i % parts > 0) {
        CHECK(std::hypot(p.x - split[i - 1].x, p.y - split[i - 1].y, p.z - split[i - 1].z) > 0.01F * s.radius);
      }
    }
  }
}

TEST_CASE(
    "parts are in the chains of their sphere, and their pairs are ignored pairs and rest pairs as the spheres' are") {
  const test::OpenedAsset whole(test::random_asset(kSpheres, 1).parts);
  REQUIRE(whole.status == SC_OK);
  const SplitAsset split(whole.asset, kParts);
  const AssetView &asset = view_of(split.asset()), &of_whole = whole.view();
  REQUIRE(asset.spheres().size == kSpheres * kParts);
  REQUIRE(asset.chain_count() == of_whole.chain_count());
  for (std::size_t c = 0; c < asset.chain_count(); ++c) {
    const auto members = asset.chain(c).spheres, of = of_whole.chain(c).spheres;
    REQUIRE(members.size == kParts * of.size);
    for (std::size_t i = 0; i < members.size; ++i) {
      CHECK(members[i] == kParts * of[i / kParts] + i % kParts);
    }
  }
  std::size_t rest_pairs = 0;
  for (std::uint32_t b = 1; b < kSpheres * kParts; ++b) {
    for (std::uint32_t a = 0; a < b; ++a) {
      const Pair parents{a / kParts, b / kParts};
      const bool ignored = parents.a == parents.b || is_ignored(of_whole, parents.a, parents.b);
      CHECK(is_ignored(asset, a, b) == ignored);
      if (a % kParts == 0 || b % kParts == kParts - 1) {  // enough, for looking each up takes long
        CHECK(rest_scale_of(asset, {a, b}) == rest_scale_of(of_whole, parents));
      }
      rest_pairs += parents.a != parents.b && rest_scale_of(of_whole, parents) >= 0 ? 1 : 0;
    }
  }
  CHECK(rest_pairs == asset.rest_pairs(SC_RADIUS_FIT).size);
}

TEST_CASE("parts touch only where their spheres do") {
  const test::OpenedAsset whole(test::random_asset(kSpheres, 4).parts);
  REQUIRE(whole.status == SC_OK);
  const SplitAsset split(whole.asset, 20);
  std::mt19937 random(5);
  const std::vector<Sphere> spheres = test::random_spheres(kSpheres, random);
  const PlainResult of_spheres = PlainDetection(whole.view(), SC_RADIUS_FIT).all_pairs(spheres.data());
  const PlainResult of_parts =
      PlainDetection(view_of(split.asset()), SC_RADIUS_FIT).all_pairs(split.split(spheres).data());
  CHECK(of_parts.pairs.size() > of_spheres.pairs.size());
  for (const Pair& pair : of_parts.pairs) {
    const Sphere &p = spheres[pair.a / 20], &q = spheres[pair.b / 20];
    CHECK(std::hypot(p.x - q.x, p.y - q.y, p.z - q.z) < p.radius + q.radius + 1e-5F);
  }
}

TEST_CASE("more parts than an asset has room for are refused, with a sentence") {
  const test::OpenedAsset whole(test::random_asset(kSpheres, 1).parts);
  REQUIRE(whole.status == SC_OK);
  CHECK_THROWS_AS(SplitAsset(whole.asset, 0), std::runtime_error);
  CHECK_THROWS_WITH_AS(SplitAsset(whole.asset, kMaxSphereCount / kSpheres + 1), doctest::Contains("parts"),
                       std::runtime_error);
}

}  // namespace spherechain::bench
