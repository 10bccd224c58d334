// SPDX-License-Identifier: MIT
// The user's own filter, against sets of pairs kept by hand.
#include "spherechain/filter.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
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

// What an asset with these ignored pairs, and spheres with these radii, would report.
std::vector<Pair> expected(AssetParts parts, const std::set<Pair>& ignored, const std::vector<Sphere>& spheres,
                           const std::set<std::uint32_t>& disabled, Method method) {
  std::fill(parts.ignored.begin(), parts.ignored.end(), 0);
  for (const Pair& pair : ignored) {
    const std::size_t bit = std::size_t{pair.b} * (pair.b - 1) / 2 + pair.a;
    parts.ignored[bit / 64] |= std::uint64_t{1} << (bit % 64);
  }
  const OpenedAsset opened(parts);
  REQUIRE(opened.status == Status::kOk);
  std::vector<Pair> pairs;
  for (const Pair& pair : detect(opened.asset, spheres, method, RadiusKind::kDetect, Target::kScalar).pairs) {
    if (disabled.count(pair.a) + disabled.count(pair.b) == 0) pairs.push_back(pair);
  }
  return pairs;
}

}  // namespace

TEST_CASE("any edits to a filter report what an asset baked that way would, on every target, with M1 and M2") {
  for (const unsigned n : {2U, 20U, 64U, 65U, 128U, 150U}) {
    CAPTURE(n);
    std::mt19937 random(n);
    const TinyAsset tiny = random_asset(n, n);
    const OpenedAsset opened(tiny.parts);
    OwnedFilter owned(opened.asset);
    std::set<Pair> ignored(tiny.ignored_pairs.begin(), tiny.ignored_pairs.end());
    CHECK(pairs_in(owned.ignored, n) == ignored);
    std::set<std::uint32_t> disabled;
    std::vector<Sphere> spheres = random_spheres(n, random);
    std::vector<Sphere> padded = spheres;
    for (int edit = 0; edit < 60; ++edit) {
      const auto a = static_cast<std::uint32_t>(random() % n), b = static_cast<std::uint32_t>(random() % n);
      if (edit % 3 == 0 && a != b) {
        const bool on = random() % 2 == 0;
        const Pair pair{std::min(a, b), std::max(a, b)};
        REQUIRE(ignore_pair(opened.asset, owned.filter, a, b, on) == Status::kOk);
        on ? (void)ignored.insert(pair) : (void)ignored.erase(pair);
      } else if (edit % 3 == 1) {
        const bool on = random() % 4 == 0;
        REQUIRE(disable_sphere(opened.asset, owned.filter, a, on) == Status::kOk);
        on ? (void)disabled.insert(a) : (void)disabled.erase(a);
      } else {
        const float padding = uniform(random, -0.1F, 0.2F);
        REQUIRE(pad_sphere(opened.asset, owned.filter, a, padding) == Status::kOk);
        const float radius = spheres[a].radius + padding;
        padded[a].radius = radius < 0 ? kNan : radius;
      }
    }
    CHECK(pairs_in(owned.ignored, n) == ignored);
    for (const Method method : {Method::kM1, Method::kM2}) {
      const std::vector<Pair> wanted = expected(tiny.parts, ignored, padded, disabled, method);
      for (const Target target : supported_targets()) {
        const Detected got = detect(opened.asset, spheres, method, RadiusKind::kDetect, target, &owned.filter);
        CHECK(got.status == Status::kOk);
        CHECK(got.pairs == wanted);
        CHECK(got.test_count ==
              detect(opened.asset, spheres, method, RadiusKind::kDetect, Target::kScalar, &owned.filter).test_count);
      }
    }
  }
}

TEST_CASE("regions are ignored against each other, or each within itself, and taken back") {
  const TinyAsset tiny = random_asset(30, 1);
  const OpenedAsset opened(tiny.parts);
  OwnedFilter owned(opened.asset);
  std::set<Pair> ignored(tiny.ignored_pairs.begin(), tiny.ignored_pairs.end());
  const auto apply = [&](std::size_t p, std::size_t q, bool on) {
    REQUIRE(ignore_regions(opened.asset, owned.filter, p, q, on) == Status::kOk);
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

TEST_CASE("spheres at most so many places apart in a chain are ignored") {
  TinyAsset tiny = random_asset(6, 1);
  tiny.parts.ignored.assign(1, 0);
  tiny.parts.chains = {{"one", {0}, {5, 1, 3, 0}}, {"two", {1}, {2, 4}}, {"three", {1}, {4}}, {"none", {1}, {}}};
  const OpenedAsset opened(tiny.parts);
  REQUIRE_MESSAGE(opened.status == Status::kOk, opened.message);
  const auto after = [&](std::size_t hops) {
    OwnedFilter owned(opened.asset);
    REQUIRE(ignore_hops(opened.asset, owned.filter, hops) == Status::kOk);
    const std::set<Pair> pairs = pairs_in(owned.ignored, 6);
    REQUIRE(ignore_hops(opened.asset, owned.filter, hops, false) == Status::kOk);
    CHECK(pairs_in(owned.ignored, 6).empty());
    return pairs;
  };
  const std::set<Pair> next{{1, 5}, {1, 3}, {0, 3}, {2, 4}};
  std::set<Pair> two = next;
  two.insert({{3, 5}, {0, 1}});
  std::set<Pair> all = two;
  all.insert({0, 5});
  CHECK(after(0).empty());
  CHECK(after(1) == next);
  CHECK(after(2) == two);
  CHECK(after(3) == all);
  CHECK(after(std::numeric_limits<std::size_t>::max()) == all);
}

TEST_CASE("a filter that does not fit, or an edit of what is not there, is refused and changes nothing") {
  const OpenedAsset opened(random_asset(70, 1).parts);
  const Asset& asset = opened.asset;
  OwnedFilter owned(asset);
  const OwnedFilter before(asset);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(ignore_pair(asset, owned.filter, 3, 3) == Status::kBadArgument);
  CHECK(ignore_pair(asset, owned.filter, 70, 3) == Status::kBadArgument);
  CHECK(ignore_pair(asset, owned.filter, 3, 70) == Status::kBadArgument);
  CHECK(ignore_regions(asset, owned.filter, 5, 0) == Status::kBadArgument);
  CHECK(ignore_regions(asset, owned.filter, 0, 5) == Status::kBadArgument);
  CHECK(disable_sphere(asset, owned.filter, 70) == Status::kBadArgument);
  CHECK(pad_sphere(asset, owned.filter, 70, 1) == Status::kBadArgument);
  CHECK(pad_sphere(asset, owned.filter, 0, nan) == Status::kBadArgument);
  CHECK(ignore_pair(Asset(), owned.filter, 0, 1) == Status::kNotOpen);
  CHECK(check_filter(asset, owned.filter) == Status::kOk);

  const std::vector<Sphere> spheres(70, {0, 0, 0, 1});
  const auto all_refuse = [&](Status status, auto change) {
    Filter filter = owned.filter;
    change(filter);
    CHECK(check_filter(asset, filter) == status);
    CHECK(reset_filter(asset, filter) == status);
    CHECK(ignore_pair(asset, filter, 0, 1) == status);
    CHECK(ignore_regions(asset, filter, 0, 1) == status);
    CHECK(ignore_hops(asset, filter, 1) == status);
    CHECK(disable_sphere(asset, filter, 0) == status);
    CHECK(pad_sphere(asset, filter, 0, 1) == status);
    for (const Method method : {Method::kM1, Method::kM2}) {
      CHECK(detect(asset, spheres, method, RadiusKind::kFit, Target::kBest, &filter).status == status);
    }
  };
  all_refuse(Status::kBadFilter, [](Filter& f) { --f.ignored.size; });
  all_refuse(Status::kBadFilter, [](Filter& f) { ++f.ignored.size; });
  all_refuse(Status::kBadFilter, [](Filter& f) { f.ignored = {}; });
  all_refuse(Status::kBadFilter, [](Filter& f) { --f.disabled.size; });
  all_refuse(Status::kBadFilter, [](Filter& f) { ++f.padding.size; });
  all_refuse(Status::kNullArgument, [](Filter& f) { f.ignored.data = nullptr; });
  all_refuse(Status::kNullArgument, [](Filter& f) { f.disabled.data = nullptr; });
  all_refuse(Status::kNullArgument, [](Filter& f) { f.padding.data = nullptr; });
  CHECK(owned.ignored == before.ignored);
  CHECK(owned.disabled == before.disabled);
  CHECK(owned.padding == before.padding);

  Filter plain{owned.filter.ignored, {}, {}};
  CHECK(disable_sphere(asset, plain, 0) == Status::kBadFilter);
  CHECK(pad_sphere(asset, plain, 0, 1) == Status::kBadFilter);
  CHECK(detect(asset, spheres, Method::kM2, RadiusKind::kFit, Target::kBest, &plain).status == Status::kOk);
}

TEST_CASE("a filter whose buffers lie on each other, or on the asset's, is neither reset nor edited") {
  const OpenedAsset opened(random_asset(70, 1).parts);
  const Asset& asset = opened.asset;
  OwnedFilter owned(asset);
  const std::vector<std::uint64_t> before(owned.ignored.size(), 5);
  owned.ignored = before;
  const std::vector<std::uint64_t> own(asset.ignored().begin(), asset.ignored().end());
  const auto is_refused = [&](auto change) {
    Filter filter = owned.filter;
    change(filter);
    const Status all[] = {reset_filter(asset, filter),         ignore_pair(asset, filter, 0, 1),
                          ignore_regions(asset, filter, 0, 1), ignore_hops(asset, filter, 1),
                          disable_sphere(asset, filter, 0),    pad_sphere(asset, filter, 0, 1)};
    CHECK(owned.ignored == before);
    CHECK(std::equal(asset.ignored().begin(), asset.ignored().end(), own.begin()));
    return std::count(std::begin(all), std::end(all), Status::kSharedMemory) == 6;
  };
  CHECK(is_refused([&](Filter& f) { f.padding.data = reinterpret_cast<float*>(owned.ignored.data()); }));
  CHECK(is_refused([&](Filter& f) { f.disabled.data = owned.ignored.data() + owned.ignored.size() - 2; }));
  CHECK(is_refused([&](Filter& f) { f.disabled.data = reinterpret_cast<std::uint64_t*>(owned.padding.data()); }));
  CHECK(is_refused([&](Filter& f) { f.ignored.data = const_cast<std::uint64_t*>(asset.ignored().data); }));
  CHECK(reset_filter(asset, owned.filter) == Status::kOk);
}

}  // namespace spherechain::test
