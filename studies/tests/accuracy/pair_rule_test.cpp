// SPDX-License-Identifier: GPL-3.0-or-later
// Other rules for what is reported, against the runtime.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "baked_human.h"
#include "human.h"
#include "jobs.h"
#include "pair_rule.h"
#include "studies/plain_detection.h"

using namespace spherechain::baker;
using spherechain::Pair;
using spherechain::Radius;
using spherechain::Sphere;
using spherechain::test::detect;
using spherechain::test::refit;

namespace {

std::vector<Sphere> spheres_at(const OpenAsset& asset, const std::vector<Vec3>& positions, Radius kind) {
  return refit(asset, pack(positions), kind).spheres;
}

std::vector<Sphere> scaled(std::vector<Sphere> spheres, float scale) {
  for (Sphere& sphere : spheres) sphere.radius *= scale;
  return spheres;
}

// Pairs that spheres so scaled would report sooner than at the baked part of their distance at rest.
std::set<Pair> held_back(const OpenAsset& asset, float scale) {
  const std::vector<Sphere> rest =
      scaled(spheres_at(asset, paper_baked_human().character.source_positions, SC_RADIUS_DETECT), scale);
  std::set<Pair> out;
  for (std::uint32_t b = 0; b < rest.size(); ++b) {
    for (std::uint32_t a = 0; a < b; ++a) {
      const double dx = rest[a].x - rest[b].x, dy = rest[a].y - rest[b].y, dz = rest[a].z - rest[b].z;
      const double part = kPaperRestScale * std::sqrt(dx * dx + dy * dy + dz * dz);
      if (part < 1.001 * (rest[a].radius + rest[b].radius)) out.insert({a, b});
    }
  }
  return out;
}

bool contains(const std::vector<Pair>& pairs, const Pair& pair) {
  return std::binary_search(pairs.begin(), pairs.end(), pair);
}

}  // namespace

TEST_CASE("the plain rule reports what the runtime does, chains and all pairs, at either radius in every fifth frame") {
  const OpenAsset asset = open_asset_of(baked_human());
  const ChainMembers chains(asset);
  for (const Radius kind : {SC_RADIUS_FIT, SC_RADIUS_DETECT}) {
    const PairRule rule(asset, kind, {});
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < animation_frames().size(); i += 5) {
      const std::vector<Sphere> spheres = spheres_at(asset, animation_frames()[i].positions, kind);
      const std::vector<Pair> found = rule.pairs(spheres);
      CHECK(found == detect(asset, spheres, kind).pairs);
      CHECK(chains.sharing(found) == spherechain::PlainDetection(asset.view(), kind).chains(spheres.data()).pairs);
      pairs += found.size();
    }
    CHECK(pairs > 0);
  }
}

TEST_CASE("with a part of the rest distance for all pairs the rule reports each that comes nearer than that") {
  constexpr double kPart = 0.75;
  const Bake& bake = paper_baked_human();
  const OpenAsset asset = open_asset_of(bake);
  const PairRule rule(asset, SC_RADIUS_DETECT, {1, kPart});
  const std::vector<Sphere> rest = spheres_at(asset, bake.character.source_positions, SC_RADIUS_DETECT);
  const auto near = [](const std::vector<Sphere>& spheres, const Pair& pair) {
    const Sphere &a = spheres[pair.a], &b = spheres[pair.b];
    return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z) / (a.radius + b.radius);
  };
  std::size_t fewer = 0;
  for (std::size_t i = 0; i < animation_frames().size(); i += 5) {
    const std::vector<Sphere> spheres = spheres_at(asset, animation_frames()[i].positions, SC_RADIUS_DETECT);
    const std::vector<Pair> found = rule.pairs(spheres);
    const std::vector<Pair> all = detect(asset, spheres, SC_RADIUS_DETECT).pairs;
    CHECK(std::includes(all.begin(), all.end(), found.begin(), found.end()));
    for (const Pair& pair : all) {
      const float part = near(spheres, pair) / near(rest, pair);
      if (std::abs(part - kPart) < 1e-4) continue;  // rounding
      CHECK(contains(found, pair) == (part < kPart || near(rest, pair) > 1 / kPart));
    }
    fewer += all.size() - found.size();
  }
  CHECK(fewer > 0);
}

TEST_CASE("with larger radii more is reported, rest pairs at their distance as before, and nothing at rest") {
  const OpenAsset asset = open_asset_of(paper_baked_human());
  const PairRule rule(asset, SC_RADIUS_DETECT, {1.5, {}});
  const std::set<Pair> near = held_back(asset, 1.5F);
  std::size_t free = 0;
  for (std::size_t i = 0; i < animation_frames().size(); i += 5) {
    const std::vector<Sphere> spheres = spheres_at(asset, animation_frames()[i].positions, SC_RADIUS_DETECT);
    const std::vector<Pair> found = rule.pairs(spheres), before = detect(asset, spheres, SC_RADIUS_DETECT).pairs,
                            large = detect(asset, scaled(spheres, 1.5F), SC_RADIUS_DETECT).pairs;
    for (const Pair& pair : large) {
      if (near.count(pair) == 0) CHECK(contains(found, pair));
    }
    for (const Pair& pair : found) {
      if (near.count(pair) == 0) CHECK(contains(large, pair));
      free += near.count(pair) == 0 && !contains(before, pair) ? 1u : 0u;
    }
    for (const spherechain::RestPair& own : asset->rest_pairs(SC_RADIUS_DETECT)) {
      CHECK(contains(found, {own.a, own.b}) == contains(before, {own.a, own.b}));
    }
  }
  CHECK(free > 0);
  const std::vector<Sphere> rest = spheres_at(asset, paper_baked_human().character.source_positions, SC_RADIUS_DETECT);
  for (const double scale : {0.8, 1.0, 1.5, 2.0}) {
    CHECK(PairRule(asset, SC_RADIUS_DETECT, {scale, {}}).pairs(rest).empty());
  }
}
