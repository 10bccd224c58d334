// SPDX-License-Identifier: GPL-3.0-or-later
// Trees over chains: they find what all pairs finds, and every parent encloses its children.
#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "chain_trees.h"
#include "csv.h"
#include "tiny_asset.h"

using namespace spherechain;
using spherechain::paper::ChainTrees;
using spherechain::paper::Runs;

namespace {

// A chain that wanders and crosses itself, with points, equal centres and spheres that touch exactly.
std::vector<Sphere> wandering_chain(std::size_t count, std::mt19937& random) {
  std::vector<Sphere> out;
  Sphere s{0, 0, 0, 0};
  for (std::size_t i = 0; i < count; ++i) {
    if (random() % 8 != 0) {  // else it stays
      s.x += 0.25F * static_cast<float>(random() % 3) - 0.25F;
      s.y += test::uniform(random, -0.2F, 0.2F);
      s.z += 0.25F * static_cast<float>(random() % 3) - 0.25F;
    }
    s.radius = random() % 8 == 0 ? 0 : test::uniform(random, 0.01F, 0.2F);
    out.push_back(s);
  }
  return out;
}

// Several runs, some of them empty; the first one backwards.
Runs cut_into_runs(std::size_t count, std::mt19937& random) {
  Runs out(1 + random() % 5);
  for (std::uint32_t i = 0; i < count; ++i) out[i * out.size() / (count + 1)].push_back(i);
  std::reverse(out[0].begin(), out[0].end());
  out.emplace_back();
  return out;
}

bool encloses(const Sphere& parent, const Sphere& child) {
  const double dx = double{parent.x} - child.x, dy = double{parent.y} - child.y, dz = double{parent.z} - child.z;
  return std::sqrt(dx * dx + dy * dy + dz * dz) + child.radius <= parent.radius;
}

std::size_t children_outside(const ChainTrees& trees) {
  std::size_t out = 0;
  for (std::size_t l = 1; l < trees.levels().size(); ++l) {
    const ChainTrees::Level &level = trees.levels()[l], &below = trees.levels()[l - 1];
    REQUIRE(level.first_child.back() == below.spheres.size());
    for (std::size_t i = 0; i < level.spheres.size(); ++i) {
      for (std::size_t k = level.first_child[i]; k < level.first_child[i + 1]; ++k) {
        out += encloses(level.spheres[i], below.spheres[k]) ? 0 : 1;
      }
    }
  }
  return out;
}

}  // namespace

TEST_CASE("trees over moving chains find what all pairs finds, and every parent encloses its children") {
  std::mt19937 random(26);
  std::size_t found = 0, ignored = 0;
  for (const std::size_t count : {1, 2, 3, 8, 9, 65, 150}) {
    const test::TinyAsset tiny = test::random_asset(count, static_cast<unsigned>(count));
    const test::OpenedAsset asset(tiny.parts);
    REQUIRE(asset.status == SC_OK);
    const PlainDetection plain(asset.view(), SC_RADIUS_FIT);
    for (const std::size_t branching : {2, 4, 8}) {
      for (const Runs& runs : {cut_into_runs(count, random), paper::region_runs(asset.view())}) {
        ChainTrees trees(asset.view(), SC_RADIUS_FIT, runs, branching);
        for (int frame = 0; frame < 6; ++frame) {
          const std::vector<Sphere> spheres =
              frame % 2 == 0 ? wandering_chain(count, random) : test::random_spheres(count, random);
          trees.refit(spheres.data());
          const std::vector<Pair> expected = plain.all_pairs(spheres.data()).pairs;
          CHECK(trees.all_pairs().pairs == expected);
          CHECK(children_outside(trees) == 0);
          found += expected.size();
        }
      }
    }
    ignored += tiny.ignored_pairs.size();
  }
  CHECK(found > 1000);
  CHECK(ignored > 100);
}

TEST_CASE("one sphere that is not finite hides no other pair from the trees") {
  const test::OpenedAsset asset(test::random_asset(40, 3).parts);
  REQUIRE(asset.status == SC_OK);
  Runs run(1, std::vector<std::uint32_t>(40));
  std::iota(run[0].begin(), run[0].end(), 0U);
  std::mt19937 random(4);
  const std::vector<Sphere> spheres = test::random_spheres(40, random);
  for (const float bad : {test::kNan, test::kInfinity, -test::kInfinity}) {
    for (std::size_t i = 0; i < 40; ++i) {
      std::vector<Sphere> broken = spheres;
      (i % 2 == 0 ? broken[i].x : broken[i].radius) = bad;
      ChainTrees trees(asset.view(), SC_RADIUS_FIT, run, 4);
      trees.refit(broken.data());
      CHECK(trees.all_pairs().pairs == PlainDetection(asset.view(), SC_RADIUS_FIT).all_pairs(broken.data()).pairs);
    }
  }
}
