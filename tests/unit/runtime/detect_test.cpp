// SPDX-License-Identifier: MIT
// The pairs that detection finds, against plain loops.
#include <doctest/doctest.h>

#include <algorithm>

#include "jobs.h"
#include "studies/plain_detection.h"
#include "tiny_asset.h"

namespace spherechain::test {
namespace {

// A job's bits, by the formula of the header.
std::vector<std::uint64_t> bits_of(const std::vector<Pair>& pairs, std::size_t n) {
  std::vector<std::uint64_t> words((n * (n - 1) / 2 + 63) / 64);
  for (const Pair& pair : pairs) {
    const std::size_t bit = std::size_t{pair.b} * (pair.b - 1) / 2 + pair.a;
    words[bit / 64] |= std::uint64_t{1} << (bit % 64);
  }
  return words;
}

}  // namespace

TEST_CASE("the pairs are a plain loop's, at every size from 1 to 140 and some more, on every target") {
  std::size_t found = 0;
  for (unsigned n = 1; n <= 400; n += n < 140 ? 1 : 65) {
    CAPTURE(n);
    const OpenedAsset opened(random_asset(n, n).parts);
    REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
    std::mt19937 random(n);
    const std::vector<Sphere> spheres = random_spheres(n, random);
    for (const Radius radius : {SC_RADIUS_FIT, SC_RADIUS_DETECT}) {
      const PlainDetection plain(opened.view(), radius);
      const std::vector<Pair> all = plain.all_pairs(spheres.data()).pairs;
      for (const Target target : supported_targets()) {
        INFO(std::string(sc_target_name(target)));
        const Detected pairs = detect(opened.asset, spheres, radius, target);
        CHECK(pairs.status == SC_OK);
        CHECK(pairs.pairs == all);
        CHECK(pairs.bits == bits_of(all, n));
      }
      const std::vector<Pair> in_chains = plain.chains(spheres.data()).pairs;
      CHECK(std::includes(all.begin(), all.end(), in_chains.begin(), in_chains.end()));
      found += in_chains.size();
    }
  }
  CHECK(found > 40000);  // the comparison above was not of empty lists
}

TEST_CASE("by chains a pair is found once, and once a chain in chain order with repeats") {
  TinyAsset tiny = random_asset(5, 1);
  tiny.parts.ignored.assign(1, 0);
  tiny.parts.rest_detect.clear();
  tiny.parts.chains = {{"one", {0, 4}, {3, 1, 2}}, {"two", {1, 4}, {1, 0, 3}}};
  const OpenedAsset opened(tiny.parts);
  REQUIRE(opened.status == SC_OK);
  const std::vector<Sphere> heap(5, {0, 0, 0, 1});
  const PlainResult chains = PlainDetection(opened.view(), SC_RADIUS_DETECT).chains(heap.data());
  CHECK(chains.pairs == std::vector<Pair>{{0, 1}, {0, 3}, {1, 2}, {1, 3}, {2, 3}});
  const std::vector<ChainPair> raw{{0, {1, 3}}, {0, {2, 3}}, {0, {1, 2}}, {1, {0, 1}}, {1, {1, 3}}, {1, {0, 3}}};
  CHECK(same_bits(chains.chain_pairs, raw));
  CHECK(chains.test_count == 6);
  CHECK(PlainDetection(opened.view(), SC_RADIUS_DETECT).all_pairs(heap.data()).test_count == 10);
}

}  // namespace spherechain::test
