// SPDX-License-Identifier: GPL-3.0-or-later
// Which spheres of the baked human touch, at rest, in poses and over both animations.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "baked_human.h"
#include "jobs.h"
#include "studies/plain_detection.h"

using namespace spherechain::baker;
using spherechain::Pair;
using spherechain::Radius;
using spherechain::Sphere;

namespace {

using spherechain::test::detect;
using spherechain::test::Detected;
using spherechain::test::refit;

std::vector<Pair> touching(const Bake& bake, const std::vector<Vec3>& positions, Radius kind) {
  const OpenAsset asset = open_asset_of(bake);
  return detect(asset, refit(asset, pack(positions), kind).spheres, kind).pairs;
}

// Written apart from the runtime: from the baker's own lists, with sets, in the arithmetic the headers fix.
std::vector<Pair> brute_force(const Bake& bake, const std::vector<Sphere>& spheres, Radius kind) {
  const std::set<std::pair<std::uint32_t, std::uint32_t>> ignored(bake.binding.ignored.begin(),
                                                                  bake.binding.ignored.end());
  std::map<std::pair<std::uint32_t, std::uint32_t>, float> reach;
  for (const BoundPair& near : kind == SC_RADIUS_FIT ? bake.binding.rest_fit : bake.binding.rest_detect) {
    reach[{near.a, near.b}] = near.rest_scale;
  }
  std::vector<Pair> pairs;
  for (std::uint32_t a = 0; a < spheres.size(); ++a) {
    for (std::uint32_t b = a + 1; b < spheres.size(); ++b) {
      if (ignored.count({a, b}) > 0) continue;
      const float dx = spheres[a].x - spheres[b].x, dy = spheres[a].y - spheres[b].y, dz = spheres[a].z - spheres[b].z;
      float sum = spheres[a].radius + spheres[b].radius;
      if (reach.count({a, b}) > 0) sum = reach[{a, b}] * sum;
      if ((dx * dx + dy * dy) + dz * dz < sum * sum) pairs.push_back({a, b});
    }
  }
  return pairs;
}

std::uint8_t region_of(const Bake& bake, std::uint32_t sphere) { return bake.spheres.spheres[sphere].region; }

// Pairs between two regions, the torso's spheres only of one side where `side` is given.
std::size_t count_between(const Bake& bake, const std::vector<Pair>& pairs, std::uint8_t a, std::uint8_t b,
                          Side side = Side::kNone) {
  return static_cast<std::size_t>(std::count_if(pairs.begin(), pairs.end(), [&](const Pair& pair) {
    for (const auto& [p, q] : {std::pair(pair.a, pair.b), std::pair(pair.b, pair.a)}) {
      if (region_of(bake, p) != a || region_of(bake, q) != b) continue;
      if (side == Side::kNone || bake.spheres.spheres[q].side == side) return true;
    }
    return false;
  }));
}

}  // namespace

TEST_CASE("at rest no pair is reported, with either radius and either refit") {
  for (const Bake* bake : {&baked_human(), &paper_baked_human()}) {
    CHECK(touching(*bake, bake->character.source_positions, SC_RADIUS_FIT).empty());
    CHECK(touching(*bake, bake->character.source_positions, SC_RADIUS_DETECT).empty());
  }
}

TEST_CASE("hands on hips: each arm touches its own side of the torso or its own leg") {
  const Bake& bake = baked_human();
  const std::vector<Pair> pairs = touching(bake, posed_human("hands_on_hips.json"), SC_RADIUS_DETECT);
  CHECK(count_between(bake, pairs, 0, kTorso, Side::kLeft) > 0);
  CHECK(count_between(bake, pairs, 1, kTorso, Side::kRight) > 0);
  CHECK(count_between(bake, pairs, 0, kTorso, Side::kRight) == 0);
  CHECK(count_between(bake, pairs, 1, kTorso, Side::kLeft) == 0);
  CHECK(count_between(bake, pairs, 2, 3) == 0);
}

TEST_CASE("one leg over the other: leg touches leg, and no arm does") {
  const Bake& bake = baked_human();
  const std::vector<Pair> pairs = touching(bake, posed_human("leg_over_leg.json"), SC_RADIUS_DETECT);
  CHECK(count_between(bake, pairs, 2, 3) > 0);
  CHECK(count_between(bake, pairs, 0, 1) == 0);
}

TEST_CASE("arms crossed: arm touches arm or chest") {
  const Bake& bake = baked_human();
  const std::vector<Pair> pairs = touching(bake, posed_human("arms_crossed.json"), SC_RADIUS_DETECT);
  CHECK(count_between(bake, pairs, 0, 1) + count_between(bake, pairs, 0, kTorso) > 0);
  CHECK(count_between(bake, pairs, 2, 3) == 0);
}

TEST_CASE("in no frame does a hand touch its own arm, a foot its own leg or the head its own neck" *
          doctest::test_suite("many bakes")) {
  const Bake& bake = baked_human();
  std::size_t hands_touching = 0;
  for (const AnimationFrame& frame : animation_frames()) {
    for (const Pair& pair : touching(bake, frame.positions, SC_RADIUS_DETECT)) {
      const FittedSphere &a = bake.spheres.spheres[pair.a], &b = bake.spheres.spheres[pair.b];
      if (a.extremity || b.extremity) CHECK(a.region != b.region);
      if (a.region != b.region && (a.extremity || b.extremity)) ++hands_touching;
    }
  }
  CHECK(hands_touching > 0);
}

TEST_CASE("a hand behind the head touches the head") {
  const Bake& bake = baked_human();
  std::size_t found = 0;
  for (const Pair& pair : touching(bake, posed_human("hand_behind_head.json"), SC_RADIUS_DETECT)) {
    const FittedSphere &a = bake.spheres.spheres[pair.a], &b = bake.spheres.spheres[pair.b];
    found += a.region == kTorso && a.extremity && b.region == 0 && b.extremity ? 1u : 0u;
  }
  CHECK(found > 0);
}

TEST_CASE(
    "in frames of two animations and on every target all pairs equal a brute force, and the chains' are some of "
    "them, counted chain by chain" *
    doctest::test_suite("long runs")) {
  for (const Bake* bake : {&baked_human(), &paper_baked_human()}) {
    const OpenAsset asset = open_asset_of(*bake);
    for (const Radius kind : {SC_RADIUS_FIT, SC_RADIUS_DETECT}) {
      std::size_t chain_total = 0, all_total = 0, frames_touching = 0;
      for (std::size_t i = 3; i < animation_frames().size(); i += 4) {
        const std::vector<Sphere> spheres = refit(asset, pack(animation_frames()[i].positions), kind).spheres;
        const spherechain::PlainResult chains = spherechain::PlainDetection(asset.view(), kind).chains(spheres.data());
        const Detected all = detect(asset, spheres, kind);
        CHECK(all.pairs == brute_force(*bake, spheres, kind));
        for (const spherechain::Target target : spherechain::supported_targets()) {
          CHECK(detect(asset, spheres, kind, target).pairs == all.pairs);
        }
        CHECK(std::includes(all.pairs.begin(), all.pairs.end(), chains.pairs.begin(), chains.pairs.end()));
        // The paper's count: for each chain, the pairs both of whose spheres it holds.
        std::size_t raw = 0;
        for (const Chain& chain : bake->chains.chains) {
          const std::set<std::uint32_t> in(chain.spheres.begin(), chain.spheres.end());
          for (const Pair& pair : all.pairs) raw += in.count(pair.a) > 0 && in.count(pair.b) > 0 ? 1u : 0u;
        }
        CHECK(chains.chain_pairs.size() == raw);
        chain_total += chains.pairs.size();
        all_total += all.pairs.size();
        frames_touching += all.pairs.empty() ? 0u : 1u;
      }
      MESSAGE(fmt::format("{} refit, {} radius: {} of 20 frames touch, chains find {} of {} pairs",
                          bake == &baked_human() ? "moments" : "paper", kind == SC_RADIUS_FIT ? "fit" : "detect",
                          frames_touching, chain_total, all_total));
      CHECK(all_total > 0);
    }
  }
}
