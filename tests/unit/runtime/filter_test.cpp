// SPDX-License-Identifier: MIT
// The user's own ignored pairs, against sets of pairs kept by hand.
#include <doctest/doctest.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "jobs.h"
#include "owned_filter.h"
#include "tiny_asset.h"

namespace spherechain::test {
namespace {

std::set<Pair> pairs_in(const std::vector<std::uint64_t>& table, std::uint32_t n) {
  std::set<Pair> pairs;
  for (std::uint32_t b = 1; b < n; ++b) {
    for (std::uint32_t a = 0; a < b; ++a) {
      const std::size_t bit = std::size_t{b} * (b - 1) / 2 + a;
      if ((table[bit / 64] >> (bit % 64) & 1) != 0) pairs.insert({a, b});
    }
  }
  return pairs;
}

// The pairs that an asset with these ignored pairs would report.
std::vector<Pair> expected(AssetParts parts, const std::set<Pair>& ignored, const std::vector<Sphere>& spheres) {
  std::fill(parts.ignored.begin(), parts.ignored.end(), 0);
  for (const Pair& pair : ignored) {
    const std::size_t bit = std::size_t{pair.b} * (pair.b - 1) / 2 + pair.a;
    parts.ignored[bit / 64] |= std::uint64_t{1} << (bit % 64);
  }
  const OpenedAsset opened(parts);
  REQUIRE(opened.status == SC_OK);
  return detect(opened.asset, spheres, SC_RADIUS_DETECT, SC_TARGET_SCALAR).pairs;
}

}  // namespace

TEST_CASE("any edits to ignored pairs report what an asset baked that way would, on every target") {
  for (const unsigned n : {2U, 20U, 64U, 65U, 128U, 150U}) {
    CAPTURE(n);
    std::mt19937 random(n);
    const TinyAsset tiny = random_asset(n, n);
    const OpenedAsset opened(tiny.parts);
    OwnedFilter owned(opened.asset);
    std::set<Pair> ignored(tiny.ignored_pairs.begin(), tiny.ignored_pairs.end());
    CHECK(pairs_in(owned.ignored, n) == ignored);
    const std::vector<Sphere> spheres = random_spheres(n, random);
    for (int edit = 0; edit < 60; ++edit) {
      const auto a = static_cast<std::uint32_t>(random() % n), b = static_cast<std::uint32_t>(random() % n);
      if (a == b) continue;
      const bool on = random() % 2 == 0;
      const Pair pair{std::min(a, b), std::max(a, b)};
      owned.ignore(a, b, on);
      on ? (void)ignored.insert(pair) : (void)ignored.erase(pair);
    }
    CHECK(pairs_in(owned.ignored, n) == ignored);
    const std::vector<Pair> wanted = expected(tiny.parts, ignored, spheres);
    for (const Target target : supported_targets()) {
      const Detected got = detect(opened.asset, spheres, SC_RADIUS_DETECT, target, &owned.filter);
      CHECK(got.status == SC_OK);
      CHECK(got.pairs == wanted);
    }
  }
}

TEST_CASE("body parts are ignored against each other, or each within itself, and taken back") {
  const TinyAsset tiny = random_asset(30, 1);
  const OpenedAsset opened(tiny.parts);
  OwnedFilter owned(opened.asset);
  std::set<Pair> ignored(tiny.ignored_pairs.begin(), tiny.ignored_pairs.end());
  const auto apply = [&](std::size_t p, std::size_t q, bool on) {
    REQUIRE(sc_ignore_parts(&opened.asset, owned.ignored.data(), p, q, on ? 1 : 0) == SC_OK);
    for (std::uint32_t b = 0; b < 30; ++b) {
      for (std::uint32_t a = 0; a < b; ++a) {
        const std::size_t in_a = a % 5, in_b = b % 5;  // as random_asset deals them out
        if (std::set{in_a, in_b} == std::set{p, q}) on ? (void)ignored.insert({a, b}) : (void)ignored.erase({a, b});
      }
    }
    CHECK(pairs_in(owned.ignored, 30) == ignored);
  };
  apply(0, 4, true);
  apply(4, 1, true);
  apply(2, 2, true);
  apply(4, 0, false);
  apply(2, 2, false);
}

TEST_CASE("an edit of what is not there, or in a buffer that is not there, is refused and changes nothing") {
  const OpenedAsset opened(random_asset(70, 1).parts);
  const Asset* const asset = &opened.asset;
  const Asset closed{};
  OwnedFilter owned(*asset);
  const OwnedFilter before(*asset);
  std::uint64_t* const words = owned.ignored.data();
  constexpr sc_status kNoSuchIndex{SC_BAD_VALUE, SC_FIELD_INDEX};
  CHECK(sc_ignore_parts(asset, words, 5, 0, 1) == kNoSuchIndex);
  CHECK(sc_ignore_parts(asset, words, 0, 5, 1) == kNoSuchIndex);
  CHECK(sc_ignore_parts(nullptr, words, 0, 1, 1) == sc_status{SC_NULL, SC_FIELD_ASSET});
  CHECK(sc_ignore_parts(&closed, words, 0, 1, 1) == sc_status{SC_NOT_OPEN, SC_FIELD_ASSET});
  const auto refuses = [&](std::uint64_t* wrong, sc_code code) {
    CHECK(sc_ignore_parts(asset, wrong, 0, 1, 1) == sc_status{code, SC_FIELD_IGNORED_PAIRS});
  };
  refuses(nullptr, SC_NULL);
  refuses(reinterpret_cast<std::uint64_t*>(reinterpret_cast<char*>(words) + 4), SC_MISALIGNED);
  refuses(const_cast<std::uint64_t*>(sc_asset_get_info(asset).ignored_pairs), SC_ALIASED);

  const std::vector<Sphere> spheres(70, {0, 0, 0, 1});
  const auto refused = [&](sc_code code, auto change) {
    Filter wrong = owned.filter;
    change(wrong);
    CHECK(detect(*asset, spheres, SC_RADIUS_FIT, SC_TARGET_BEST, &wrong).status ==
          sc_status{code, SC_FIELD_IGNORED_PAIRS});
  };
  refused(SC_TOO_SMALL, [](Filter& f) { --f.ignored_words; });
  refused(SC_TOO_SMALL, [](Filter& f) { f.ignored_words = 0; });
  refused(SC_NULL, [](Filter& f) { f.ignored = nullptr; });
  CHECK(owned.ignored == before.ignored);
}

}  // namespace spherechain::test
