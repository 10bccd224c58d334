// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/chains/chains.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <set>

#include "baked_human.h"

using namespace spherechain::baker;

namespace {

using Ids = std::vector<std::uint32_t>;

// A made-up body: torso levels with spheres on these sides, a head, limbs of the given lengths.
Spheres stick_figure(int levels, const std::vector<std::size_t>& limbs, int head = 0,
                     const std::vector<Side>& sides = {Side::kLeft, Side::kRight}) {
  Spheres spheres;
  spheres.of_region.resize(limbs.size() + 1);
  spheres.level_heights.resize(static_cast<std::size_t>(levels));
  const auto torso = static_cast<std::uint8_t>(limbs.size());
  const auto add = [&](std::uint8_t region, int level, Side side, bool extremity = false) {
    spheres.of_region[region].push_back(static_cast<std::uint32_t>(spheres.spheres.size()));
    spheres.spheres.push_back({{Vec3::Zero(), 1}, region, level, side, Vec3::UnitY(), extremity});
  };
  for (int level = 0; level < levels; ++level) {
    for (const Side side : sides) add(torso, level, side);
  }
  for (int i = 0; i < head; ++i) add(torso, levels + i, Side::kNone, true);
  for (std::uint8_t limb = 0; limb < limbs.size(); ++limb) {
    for (std::size_t i = 0; i < limbs[limb]; ++i) add(limb, -1, Side::kNone);
  }
  return spheres;
}

const std::vector<LimbPlace> kBiped{
    {0, Side::kLeft, 1}, {1, Side::kRight, 1}, {2, Side::kLeft, 0}, {3, Side::kRight, 0}};

}  // namespace

TEST_CASE("the rule gives the paper's Table 1 for a biped") {
  // 0..7 torso (even left), 8 9 left arm, 10 11 right arm, 12 13 left leg, 14 15 right leg; roots first.
  const Chains chains = build_chains(stick_figure(4, {2, 2, 2, 2}), kBiped);
  REQUIRE(chains.chains.size() == 6);
  CHECK(chains.chains[0].spheres == Ids{9, 8, 6, 4, 2, 0, 12, 13});       // R0 L R2
  CHECK(chains.chains[1].spheres == Ids{11, 10, 7, 5, 3, 1, 14, 15});     // R1 R R3
  CHECK(chains.chains[2].spheres == Ids{9, 8, 6, 7, 10, 11});             // R0 T R1
  CHECK(chains.chains[3].spheres == Ids{13, 12, 0, 1, 14, 15});           // R2 D R3
  CHECK(chains.chains[4].spheres == Ids{9, 8, 6, 7, 5, 3, 1, 14, 15});    // R0 T R R3
  CHECK(chains.chains[5].spheres == Ids{11, 10, 7, 6, 4, 2, 0, 12, 13});  // R1 T L R2
  CHECK(chains.chains[4].name == "zeta4");
  CHECK(chains.chains[4].regions == std::vector<std::uint8_t>{0, kTorso, 3});
}

TEST_CASE("the paper's 46 spheres make its 138 chain entries, 136 as sets") {
  const Chains chains = build_chains(stick_figure(4, {9, 9, 10, 10}), kBiped);
  CHECK(chains.entries_table1 == 138);
  CHECK(chains.entries() == 136);
}

TEST_CASE("the head is in every chain with an arm, and T stays the top level of the torso proper") {
  // 0..3 torso, 4 neck, 5 head, then limbs of one: 6 7 arms, 8 9 legs.
  const Chains chains = build_chains(stick_figure(2, {1, 1, 1, 1}, 2), kBiped);
  CHECK(chains.chains[0].spheres == Ids{6, 5, 4, 2, 0, 8});     // R0 head L R2
  CHECK(chains.chains[2].spheres == Ids{6, 5, 4, 2, 3, 7});     // R0 head T R1
  CHECK(chains.chains[3].spheres == Ids{8, 0, 1, 9});           // R2 D R3: legs only
  CHECK(chains.chains[4].spheres == Ids{6, 5, 4, 2, 3, 1, 9});  // R0 head T R R3
}

TEST_CASE("a torso sphere in the middle of its level is on both sides") {
  // Three a level: 0 1 2 below, 3 4 5 above (left, middle, right); 6 7 arms, 8 9 legs.
  const Chains chains =
      build_chains(stick_figure(2, {1, 1, 1, 1}, 0, {Side::kLeft, Side::kNone, Side::kRight}), kBiped);
  CHECK(chains.chains[0].spheres == Ids{6, 4, 3, 1, 0, 8});  // R0 L R2
  CHECK(chains.chains[1].spheres == Ids{7, 5, 4, 2, 1, 9});  // R1 R R3
  CHECK(chains.chains[2].spheres == Ids{6, 3, 4, 5, 7});     // R0 T R1
}

TEST_CASE(
    "entries as Table 1 counts them are 3x + 2t + 3|T| + |D| on the baked human, 5 more for a sphere of the head") {
  for (const Bake* bake : {&baked_human(), &paper_baked_human()}) {
    std::size_t x = 0, t = 0, top = 0, down = 0, head = 0;
    const int highest = static_cast<int>(bake->spheres.level_heights.size()) - 1;
    for (const FittedSphere& sphere : bake->spheres.spheres) {
      if (sphere.region != kTorso) {
        ++x;
      } else if (sphere.level > highest) {
        ++head;
      } else {
        ++t;
        top += sphere.level == highest ? 1u : 0u;
        down += sphere.level == 0 ? 1u : 0u;
      }
    }
    CHECK(bake->chains.entries_table1 == 3 * x + 2 * t + 3 * top + down + 5 * head);
  }
}

TEST_CASE("a chain is a set, and every sphere is in some chain") {
  const Bake& bake = baked_human();
  std::set<std::uint32_t> seen;
  for (const Chain& chain : bake.chains.chains) {
    const std::set<std::uint32_t> set(chain.spheres.begin(), chain.spheres.end());
    CHECK(set.size() == chain.spheres.size());
    seen.insert(set.begin(), set.end());
  }
  CHECK(seen.size() == bake.spheres.spheres.size());
}

TEST_CASE("with a limb in the middle a chain goes along the other limb's side") {
  const auto chain = [](Side upper, Side lower) {  // 0 1 below, 2 3 above (left, right); 4 and 5 the limbs
    return build_chains(stick_figure(2, {1, 1}), {{0, upper, 1}, {1, lower, 0}}).chains.at(0).spheres;
  };
  CHECK(chain(Side::kLeft, Side::kNone) == Ids{4, 2, 0, 5});
  CHECK(chain(Side::kNone, Side::kRight) == Ids{4, 3, 1, 5});
}
