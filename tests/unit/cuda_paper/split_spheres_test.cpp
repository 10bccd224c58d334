// SPDX-License-Identifier: MIT
#include "split_spheres.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "jobs.h"
#include "tiny_asset.h"

namespace spherechain::bench {
namespace {

constexpr std::uint32_t kParts = 7;
constexpr std::size_t kSpheres = 30;

bool is_ignored(const Asset& asset, std::size_t a, std::size_t b) {
  const std::size_t bit = b * (b - 1) / 2 + a;
  return ((asset.ignored()[bit / 64] >> (bit % 64)) & 1U) != 0;
}

float reach_of(const Asset& asset, const Pair& pair) {
  for (const NearPair& near : asset.near_pairs(RadiusKind::kFit)) {
    if (Pair{near.a, near.b} == pair) {
      return near.reach;
    }
  }
  return -1;
}

}  // namespace

TEST_CASE("a sphere's parts lie inside it, are alike, and have its volume together") {
  const test::OpenedAsset whole(test::random_asset(kSpheres, 1).parts);
  REQUIRE(whole.status == Status::kOk);
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

TEST_CASE("parts are in the chains of their sphere, and their pairs are ignored and near as the spheres' are") {
  const test::OpenedAsset whole(test::random_asset(kSpheres, 1).parts);
  REQUIRE(whole.status == Status::kOk);
  const SplitAsset split(whole.asset, kParts);
  const Asset& asset = split.asset();
  REQUIRE(asset.spheres().size == kSpheres * kParts);
  REQUIRE(asset.chain_count() == whole.asset.chain_count());
  for (std::size_t c = 0; c < asset.chain_count(); ++c) {
    const auto members = asset.chain(c).spheres, of = whole.asset.chain(c).spheres;
    REQUIRE(members.size == kParts * of.size);
    for (std::size_t i = 0; i < members.size; ++i) {
      CHECK(members[i] == kParts * of[i / kParts] + i % kParts);
    }
  }
  std::size_t near = 0;
  for (std::uint32_t b = 1; b < kSpheres * kParts; ++b) {
    for (std::uint32_t a = 0; a < b; ++a) {
      const Pair parents{a / kParts, b / kParts};
      const bool ignored = parents.a == parents.b || is_ignored(whole.asset, parents.a, parents.b);
      CHECK(is_ignored(asset, a, b) == ignored);
      if (a % kParts == 0 || b % kParts == kParts - 1) {  // enough, for looking each up takes long
        CHECK(reach_of(asset, {a, b}) == reach_of(whole.asset, parents));
      }
      near += parents.a != parents.b && reach_of(whole.asset, parents) >= 0 ? 1 : 0;
    }
  }
  CHECK(near == asset.near_pairs(RadiusKind::kFit).size);
}

TEST_CASE("parts touch only where their spheres do") {
  const test::OpenedAsset whole(test::random_asset(kSpheres, 4).parts);
  REQUIRE(whole.status == Status::kOk);
  const SplitAsset split(whole.asset, 20);
  std::mt19937 random(5);
  const std::vector<Sphere> spheres = test::random_spheres(kSpheres, random);
  const test::Detected of_spheres = test::detect(whole.asset, spheres, Method::kM2, RadiusKind::kFit);
  const test::Detected of_parts = test::detect(split.asset(), split.split(spheres), Method::kM2, RadiusKind::kFit);
  CHECK(of_parts.pairs.size() > of_spheres.pairs.size());
  for (const Pair& pair : of_parts.pairs) {
    const Sphere &p = spheres[pair.a / 20], &q = spheres[pair.b / 20];
    CHECK(std::hypot(p.x - q.x, p.y - q.y, p.z - q.z) < p.radius + q.radius + 1e-5F);
  }
}

TEST_CASE("more parts than an asset has room for are refused, with a sentence") {
  const test::OpenedAsset whole(test::random_asset(kSpheres, 1).parts);
  REQUIRE(whole.status == Status::kOk);
  CHECK_THROWS_AS(SplitAsset(whole.asset, 0), std::runtime_error);
  CHECK_THROWS_WITH_AS(SplitAsset(whole.asset, kMaxSphereCount / kSpheres + 1), doctest::Contains("parts"),
                       std::runtime_error);
}

}  // namespace spherechain::bench
