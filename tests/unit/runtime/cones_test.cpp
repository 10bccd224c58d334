// SPDX-License-Identifier: MIT
// Cones against a slow search of the least gap in double precision, targets against each other, and what a table says.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "jobs.h"
#include "owned_filter.h"
#include "pairs/cone.h"
#include "pairs/pair_bits.h"
#include "tiny_asset.h"

namespace spherechain::test {
namespace {

struct Ends {
  Sphere from, to;
};

// The least of a function that falls and then rises, from 0 to 1.
template <typename Function>
double least(const Function& function) {
  double low = 0, high = 1;
  for (int i = 0; i < 80; ++i) {
    const double left = low + (high - low) / 3, right = high - (high - low) / 3;
    (function(left) < function(right) ? high : low) = function(left) < function(right) ? right : left;
  }
  return std::min({function(low), function(0.0), function(1.0)});
}

// Of the balls of one with those of the other, their radii times `scale`: convex in both places.
double least_gap(const Ends& a, const Ends& b, double scale) {
  const auto at = [](double from, double to, double share) { return from + share * (to - from); };
  const auto gap = [&](double s, double t) {
    const double x = at(double{a.from.x}, double{a.to.x}, s) - at(double{b.from.x}, double{b.to.x}, t);
    const double y = at(double{a.from.y}, double{a.to.y}, s) - at(double{b.from.y}, double{b.to.y}, t);
    const double z = at(double{a.from.z}, double{a.to.z}, s) - at(double{b.from.z}, double{b.to.z}, t);
    const double radii =
        at(double{a.from.radius}, double{a.to.radius}, s) + at(double{b.from.radius}, double{b.to.radius}, t);
    return std::sqrt(x * x + y * y + z * z) - scale * radii;
  };
  return least([&](double s) { return least([&](double t) { return gap(s, t); }); });
}

// Whether neither ball is inside the other: else the cone is the larger alone, whatever radii are multiplied with.
bool has_sides(const Ends& of) {
  const double x = double{of.to.x} - of.from.x, y = double{of.to.y} - of.from.y, z = double{of.to.z} - of.from.z;
  return std::sqrt(x * x + y * y + z * z) > std::abs(double{of.to.radius} - of.from.radius) + 1e-3;
}

Sphere ball(std::mt19937& random, float radius) {
  return {uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, 0, radius)};
}

// Any, or one of what a closed form stumbles over.
Ends draw(std::mt19937& random, const Ends* other) {
  Ends out{ball(random, 0.5F), ball(random, 0.5F)};
  const auto moved = [&](const Sphere& by, float share) {
    return Sphere{out.from.x + share * by.x, out.from.y + share * by.y, out.from.z + share * by.z, out.to.radius};
  };
  switch (random() % 10) {
    case 0:
      out.to = out.from;
      break;
    case 1:  // in one place, of other size
      out.to = out.from, out.to.radius = uniform(random, 0, 0.5F);
      break;
    case 2:  // just inside, just outside
      out.to = moved({1, 0, 0, 0}, 0.25F), out.to.radius = out.from.radius + 0.25F;
      if (random() % 2 == 0) out.to.radius = std::nextafter(out.to.radius, 0.0F);
      break;
    case 3:
      out.to.radius = out.from.radius;
      break;
    case 4:
    case 5:
      if (other != nullptr) {  // parallel, or nearly
        const Sphere& a = other->from;
        const Sphere& b = other->to;
        const float off = random() % 2 == 0 ? 0.0F : 1e-4F;
        out.to = moved({b.x - a.x + off, b.y - a.y, b.z - a.z, 0}, uniform(random, -2, 2));
        if (random() % 2 == 0) out.to.radius = out.from.radius;
      }
      break;
    case 6:
      if (other != nullptr) out.from = other->to;  // end to end
      break;
    case 7:
      out.from.radius = out.to.radius = 0;
      break;
    default:
      break;
  }
  return out;
}

OpenedAsset& asset_of(std::size_t spheres) {
  static std::vector<std::unique_ptr<OpenedAsset>> opened;
  AssetParts parts = random_asset(spheres, 1).parts;
  parts.ignored.assign(parts.ignored.size(), 0);
  opened.push_back(std::make_unique<OpenedAsset>(parts));
  return *opened.back();
}

using Table = std::vector<std::uint64_t>;
Table table_of(const Asset& asset, const std::vector<Pair>& links, const std::vector<Sphere>* rest = nullptr,
               const Filter* filter = nullptr) {
  Table words(sc_cone_table_words(links.size()));
  REQUIRE(sc_prepare_cones(&asset, filter, links.data(), links.size(), rest != nullptr ? rest->data() : nullptr,
                           words.data(), words.size()) == SC_OK);
  return words;
}

// Counts first, then lists; on every target the same.
std::vector<Pair> find(const Asset& asset, const std::vector<Sphere>& spheres, const Table& table) {
  std::vector<Pair> first;
  std::size_t count = 0;
  const sc_target* const targets = sc_supported_targets(&count);
  for (std::size_t i = 0; i < count; ++i) {
    ConeJob job;
    job.asset = &asset;
    job.spheres = spheres.data();
    job.sphere_count = spheres.size();
    job.target = targets[i];
    job.table = table.data();
    REQUIRE(job.run() == SC_OK);
    std::vector<Pair> pairs(job.pair_count);
    job.pairs = pairs.data();
    job.pair_capacity = pairs.size();
    REQUIRE(job.run() == SC_OK);
    REQUIRE(job.pair_count == pairs.size());
    if (i == 0) first = pairs;
    CHECK(pairs == first);
  }
  return first;
}

}  // namespace

TEST_CASE("cones touch where a ball of the one overlaps a ball of the other, degenerate ones too") {
  std::mt19937 random(5);
  int touching = 0, apart = 0;
  for (int i = 0; i < 700; ++i) {
    const Ends a = draw(random, nullptr), b = draw(random, &a);
    const float scale = random() % 2 == 0 && has_sides(a) && has_sides(b) ? uniform(random, 0.1F, 2) : 1.0F;
    const double gap = least_gap(a, b, double{scale});
    CAPTURE(i);
    CAPTURE(gap);
    const bool found = cones_touch(cone_of(a.from, a.to), cone_of(b.from, b.to), scale);
    if (gap < -2e-5) CHECK(found);
    if (gap > 2e-5) CHECK_FALSE(found);
    (found ? touching : apart) += 1;
  }
  CHECK(touching > 100);
  CHECK(apart > 100);
}

TEST_CASE("the sides of a cone touch where neither end and no ball in the middle does") {
  const Cone post = cone_of({0, 0, 0, 1}, {10, 0, 0, 3});
  // At the height y over x = 4 the gap to the ball at x is |(x - 4, y)| - (1 + x / 5): y cos a - 1.8, sin a = 1 / 5.
  for (const double off : {-1e-4, 1e-4}) {
    const auto y = static_cast<float>((1.8 + 0.5 + off) / std::sqrt(0.96));
    CHECK(cones_touch(post, cone_of({4, y, 0, 0.5F}, {4, y, 0, 0.5F}), 1) == (off < 0));
    CHECK(cones_touch(post, cone_of({4, y, -9, 0.5F}, {4, y, 9, 0.5F}), 1) == (off < 0));  // a bar across
    CHECK(cones_touch(cone_of({4, y, 9, 0.5F}, {4, y, -9, 0.5F}), post, 1) == (off < 0));
  }
}

TEST_CASE("jobs with cones find what the rule says of each pair, far from the origin too") {
  for (const std::size_t n : {2U, 17U, 90U}) {
    const OpenedAsset& opened = asset_of(n);
    std::mt19937 random(static_cast<unsigned>(n));
    for (const float offset : {0.0F, 3e4F, -1.0F}) {  // the last: on a grid, where axes are parallel and radii equal
      std::vector<Pair> links;
      for (std::size_t i = 0; i < 3 * n && links.size() < 180; ++i) {
        links.push_back({static_cast<std::uint32_t>(random() % n), static_cast<std::uint32_t>(random() % n)});
      }
      Table table = table_of(opened.asset, links);
      std::vector<Sphere> spheres = random_spheres(n, random);
      for (Sphere& s : spheres) s.x += offset, s.y -= offset, s.radius *= 0.3F;
      for (Sphere& s : spheres) {
        const auto figure = [&](std::uint32_t end) { return static_cast<float>(random() % end); };
        if (offset < 0) s = {figure(5), figure(3), figure(3), 0.55F};
      }
      spheres[n / 2].radius = n > 2 ? kNan : spheres[n / 2].radius;
      std::vector<Pair> expected;
      for (std::uint32_t a = 0; a < links.size(); ++a) {
        for (std::uint32_t b = a + 1; b < links.size(); ++b) {
          const auto [p, q] = links[a];
          const auto [r, s] = links[b];
          const float scale = random() % 4 == 0 ? uniform(random, 0, 1.5F) : 1.0F;
          REQUIRE(sc_scale_cones(table.data(), table.size(), a, b, p == r || p == s || q == r || q == s ? -1 : scale) ==
                  SC_OK);
          if (p == r || p == s || q == r || q == s) continue;
          bool is_whole = true;
          for (const auto i : {p, q, r, s}) is_whole = is_whole && is_cone_end(spheres[i]);
          if (is_whole && cones_touch(cone_of(spheres[p], spheres[q]), cone_of(spheres[r], spheres[s]), scale)) {
            expected.push_back({a, b});
          }
        }
      }
      CHECK(find(opened.asset, spheres, table) == expected);
    }
  }
}

TEST_CASE("links of a sphere with itself find what spheres find") {
  const OpenedAsset opened(random_asset(60, 3).parts);
  std::vector<Pair> links;
  for (std::uint32_t i = 0; i < 60; ++i) links.push_back({i, i});
  Table table = table_of(opened.asset, links);
  for (const RestPair& pair : opened.view().rest_pairs(SC_RADIUS_DETECT)) {
    if (!test_bit(opened.view().ignored(), ignored_bit(pair.a, pair.b))) {
      REQUIRE(sc_scale_cones(table.data(), table.size(), pair.a, pair.b, pair.rest_scale) == SC_OK);
    }
  }
  std::mt19937 random(8);
  std::size_t found = 0;
  for (int i = 0; i < 20; ++i) {
    const std::vector<Sphere> spheres = random_spheres(60, random);
    const std::vector<Pair> expected = detect(opened.asset, spheres, SC_RADIUS_DETECT).pairs;
    CHECK(find(opened.asset, spheres, table) == expected);
    found += expected.size();
  }
  CHECK(found > 100);
}

TEST_CASE("links that share a sphere, are neighbours or disabled never touch; one neighbour among four is not enough") {
  AssetParts parts = random_asset(6, 1).parts;
  parts.ignored.assign(parts.ignored.size(), 0);
  const auto ignore = [&](std::size_t a, std::size_t b) { parts.ignored[0] |= std::uint64_t{1} << ignored_bit(a, b); };
  ignore(1, 2);
  const OpenedAsset opened(parts);
  for (const std::size_t a : {0U, 1U}) ignore(a, 2), ignore(a, 3);
  const OpenedAsset neighbours(parts);
  const std::vector<Pair> links{{0, 1}, {3, 2}, {1, 4}, {5, 5}};
  const std::vector<Sphere> heap(6, {0, 0, 0, 1});
  CHECK(find(opened.asset, heap, table_of(opened.asset, links)) ==
        std::vector<Pair>{{0, 1}, {0, 3}, {1, 2}, {1, 3}, {2, 3}});
  CHECK(find(neighbours.asset, heap, table_of(neighbours.asset, links)) ==
        std::vector<Pair>{{0, 3}, {1, 2}, {1, 3}, {2, 3}});
  OwnedFilter owned(opened.asset);
  REQUIRE(sc_disable_sphere(&opened.asset, &owned.filter, 4, 1) == SC_OK);
  CHECK(find(opened.asset, heap, table_of(opened.asset, links, nullptr, &owned.filter)) ==
        std::vector<Pair>{{0, 1}, {0, 3}, {1, 3}});
}

TEST_CASE("links that touch at rest are reported where they come nearer, to 0.9 of the scale they touch with") {
  const OpenedAsset& opened = asset_of(4);
  const std::vector<Pair> links{{0, 1}, {2, 3}};
  const auto posed = [](float height) {
    return std::vector<Sphere>{{0, 0, 0, 1}, {4, 0, 0, 1}, {2, height, -2, 1}, {2, height, 2, 1}};
  };
  const std::vector<Sphere> rest = posed(1.6F), apart = posed(2.5F);
  const Table table = table_of(opened.asset, links, &rest), plain = table_of(opened.asset, links, &apart);
  CHECK(find(opened.asset, rest, table).empty());
  CHECK(find(opened.asset, posed(1.45F), table).empty());
  CHECK(find(opened.asset, posed(1.43F), table).size() == 1);
  CHECK(find(opened.asset, posed(1.99F), plain).size() == 1);
  CHECK(find(opened.asset, posed(2.01F), plain).empty());
}

TEST_CASE("a full list keeps the first pairs and says how many there are; another asset's table is refused") {
  const OpenedAsset &opened = asset_of(30), &other = asset_of(30);
  std::vector<Pair> links;
  for (std::uint32_t i = 0; i + 1 < 30; i += 2) links.push_back({i, i + 1});
  const std::vector<Sphere> heap(30, {0, 0, 0, 1});
  const Table table = table_of(opened.asset, links);
  ConeJob job;
  job.asset = &opened.asset;
  job.spheres = heap.data();
  job.sphere_count = heap.size();
  job.table = table.data();
  std::vector<Pair> pairs(20);
  job.pairs = pairs.data();
  job.pair_capacity = pairs.size();
  CHECK(job.run() == sc_status{SC_OVERFLOW, SC_FIELD_PAIRS});
  CHECK(job.pair_count == 105);
  CHECK(pairs[0] == Pair{0, 1});
  CHECK(pairs[19] == Pair{1, 7});
  job.asset = &other.asset;
  CHECK(job.run() == sc_status{SC_BAD_VALUE, SC_FIELD_TABLE});
}

TEST_CASE(
    "an asset's own links join neighbours of a region that follow each other in a chain, once; the rest is alone") {
  AssetParts parts = random_asset(6, 1).parts;
  parts.ignored.assign(parts.ignored.size(), 0);
  for (const Pair& pair : {Pair{0, 1}, Pair{1, 2}, Pair{2, 3}}) {
    parts.ignored[0] |= std::uint64_t{1} << ignored_bit(pair.a, pair.b);
  }
  for (std::size_t i = 0; i < 6; ++i) parts.spheres[i].region = i < 3 ? 0 : 1;
  parts.chains = {{"zeta0", {0, 1}, {2, 1, 0, 3, 4}}, {"zeta1", {0, 1}, {0, 1, 2, 3}}};
  const OpenedAsset opened(parts);
  REQUIRE_MESSAGE(opened.status == SC_OK, opened.message);
  std::vector<Pair> links(3);
  CHECK(sc_chain_links(&opened.asset, links.data(), links.size()) == 5);
  CHECK(links == std::vector<Pair>{{0, 1}, {1, 2}, {3, 3}});
}

}  // namespace spherechain::test
