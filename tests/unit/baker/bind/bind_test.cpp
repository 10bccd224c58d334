// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/bind/bind.h"
#include "baker/bind/neighbours.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "baked_human.h"

using namespace spherechain::baker;

TEST_CASE("a triangle belongs to the nearest sphere of its own region") {
  const Bake& bake = baked_human();
  const Mesh& mesh = bake.character.skin;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += 7) {
    const Triangle& v = mesh.triangles[t];
    const Vec3 centroid = (mesh.positions[v[0]] + mesh.positions[v[1]] + mesh.positions[v[2]]) / 3;
    const FittedSphere& owner = bake.spheres.spheres[bake.binding.sphere_of_triangle[t]];
    CHECK(owner.region == bake.regions.of_skin[t]);
    for (const FittedSphere& other : bake.spheres.spheres) {
      if (other.region != owner.region) continue;
      CHECK((owner.ball.center - centroid).norm() <= (other.ball.center - centroid).norm() + 1e-12);
    }
  }
}

TEST_CASE("calibrated pivots carry their sphere exactly, from inside their hull or nearly") {
  const Bake& bake = baked_human();
  for (std::size_t i = 0; i < bake.binding.spheres.size(); ++i) {
    const BoundSphere& sphere = bake.binding.spheres[i];
    CHECK(sphere.pivots.size() >= 8);
    CHECK(sphere.weight_sum <= 1.5);
    double sum = 0;
    Vec3 center = Vec3::Zero();
    std::set<Index> distinct;
    for (const BoundPivot& pivot : sphere.pivots) {
      sum += pivot.weight;
      center += pivot.weight * triangle_centroid(bake.character.skin, pivot.triangle);
      distinct.insert(pivot.triangle);
      CHECK(bake.binding.sphere_of_triangle[pivot.triangle] == i);
    }
    CHECK(sum == doctest::Approx(1));
    CHECK((center - bake.spheres.spheres[i].ball.center).norm() < 1e-9);
    CHECK(distinct.size() == sphere.pivots.size());
  }
}

TEST_CASE("the paper's pivots are four, of equal weight, around the sphere" * doctest::test_suite("many bakes")) {
  const Bake& bake = paper_baked_human();
  for (std::size_t i = 0; i < bake.binding.spheres.size(); ++i) {
    REQUIRE(bake.binding.spheres[i].pivots.size() == 4);
    for (const BoundPivot& pivot : bake.binding.spheres[i].pivots) CHECK(pivot.weight == 0.25);
  }
}

TEST_CASE(
    "as many pivots as asked carry a sphere: the paper's of equal weight, the calibrated exactly, more if they must") {
  const Bake& bake = baked_human();
  const auto bound = [&](RefitRule rule, int pivots) {
    BindSettings settings;
    settings.rule = rule;
    settings.pivots = pivots;
    return bind_spheres(bake.character, bake.regions, bake.spheres, settings)->spheres;
  };
  for (const int count : {2, 8, 16}) {
    for (const BoundSphere& sphere : bound(RefitRule::kPaper, count)) {
      CHECK(sphere.pivots.size() == static_cast<std::size_t>(count));
      CHECK(sphere.pivots.front().weight == doctest::Approx(1.0 / count));
      CHECK(sphere.rest.radius > 0);
    }
  }
  for (const int count : {4, 16}) {
    const std::vector<BoundSphere> spheres = bound(RefitRule::kMoments, count);
    std::size_t as_asked = 0;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      Vec3 center = Vec3::Zero();
      for (const BoundPivot& pivot : spheres[i].pivots) {
        center += pivot.weight * triangle_centroid(bake.regions.body.mesh, pivot.triangle);
      }
      CHECK((center - bake.spheres.spheres[i].ball.center).norm() < 1e-9);
      CHECK(spheres[i].weight_sum <= 1.5);
      CHECK(spheres[i].pivots.size() >= static_cast<std::size_t>(count));
      as_asked += spheres[i].pivots.size() == static_cast<std::size_t>(count) ? 1u : 0u;
    }
    CHECK(as_asked > spheres.size() / 2);
  }
}

TEST_CASE("four pivots in one plane are rejected as ill-posed, more are taken") {
  // A flat disk of triangles cannot carry a centre above it; the same disk with a rim at the centre's height can.
  Mesh mesh;
  const auto add = [&](const Vec3& at) {
    const auto base = static_cast<Index>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {at, at + Vec3(0.01, 0, 0), at + Vec3(0, 0.01, 0)});
    mesh.triangles.push_back({base, base + 1, base + 2});
  };
  for (int i = 0; i < 16; ++i) add({std::cos(0.4 * i), std::sin(0.4 * i), 0});
  std::vector<Index> all(mesh.triangles.size());
  for (Index t = 0; t < all.size(); ++t) all[t] = t;
  const FittedSphere above{{{0, 0, 0.3}, 1}, 0, -1, Side::kNone, Vec3::UnitZ(), false};
  CHECK(choose_pivots(mesh, all, above, Vec3::UnitX(), RefitRule::kMoments, 8).empty());
  for (int i = 0; i < 16; ++i) {
    add({std::cos(0.4 * i), std::sin(0.4 * i), 0.7});
    all.push_back(static_cast<Index>(all.size()));
  }
  const auto pivots = choose_pivots(mesh, all, above, Vec3::UnitX(), RefitRule::kMoments, 8);
  REQUIRE(pivots.size() >= 8);
  double magnitude = 0;
  for (const BoundPivot& pivot : pivots) magnitude += std::abs(pivot.weight);
  CHECK(magnitude <= 1.5);
}

TEST_CASE(
    "the detect radius holds nine tenths of its triangles' area, and just that where it is not the fit "
    "radius") {
  const Bake& bake = baked_human();
  const Mesh& skin = bake.character.skin;
  const std::vector<BoundSphere> spheres = bind_spheres(bake.character, bake.regions, bake.spheres, {})->spheres;
  std::size_t larger = 0;
  for (std::size_t i = 0; i < spheres.size(); ++i) {
    const BoundSphere& sphere = spheres[i];
    CHECK(sphere.detect_radius >= sphere.rest.radius);
    double within = 0, just_below = 0, all = 0;
    for (Index t = 0; t < skin.triangles.size(); ++t) {
      if (bake.binding.sphere_of_triangle[t] != i) continue;
      const double area = triangle_area(skin, t), distance = (triangle_centroid(skin, t) - sphere.rest.center).norm();
      all += area;
      if (distance <= sphere.detect_radius * 1.0001) within += area;
      if (distance <= sphere.detect_radius * 0.97) just_below += area;
    }
    CHECK(within > 0.88 * all);  // eyes and teeth, which are loose, count here
    if (sphere.detect_radius == sphere.rest.radius) continue;
    ++larger;
    CHECK(just_below < 0.9 * all);
  }
  CHECK(larger > spheres.size() / 2);
}

TEST_CASE("neighbours along limbs and on the torso are ignored, and nothing far apart is") {
  const Bake& bake = baked_human();
  const auto ignored = [&](std::uint32_t a, std::uint32_t b) {
    return std::binary_search(bake.binding.ignored.begin(), bake.binding.ignored.end(),
                              std::pair<std::uint32_t, std::uint32_t>(std::minmax(a, b)));
  };
  for (std::size_t limb = 0; limb < 4; ++limb) {
    const auto& ids = bake.spheres.of_region[limb];
    for (std::size_t i = 1; i < ids.size(); ++i) CHECK(ignored(ids[i - 1], ids[i]));
    CHECK(!ignored(ids.front(), ids.back()));
  }
  for (const std::uint32_t a : bake.spheres.of_region[kTorso]) {
    for (const std::uint32_t b : bake.spheres.of_region[kTorso]) {
      if (a < b) CHECK(ignored(a, b) == (std::abs(bake.spheres.spheres[a].level - bake.spheres.spheres[b].level) <= 1));
    }
  }
  // Both wrists, both ankles, a wrist and the torso.
  const auto last = [&](std::size_t limb) { return bake.spheres.of_region[limb].back(); };
  CHECK(!ignored(last(0), last(1)));
  CHECK(!ignored(last(2), last(3)));
  CHECK(!ignored(0, last(0)));
}

TEST_CASE("spheres whose triangles share an edge are ignored, whatever the links say") {
  const Bake& bake = baked_human();
  Spheres unlinked = bake.spheres;
  unlinked.links.clear();
  const Binding binding = *bind_spheres(bake.character, bake.regions, unlinked, {});
  std::map<std::pair<Index, Index>, std::set<std::uint32_t>> owners_of_edge;
  for (std::size_t t = 0; t < bake.character.skin.triangles.size(); ++t) {
    const Triangle& v = bake.character.skin.triangles[t];
    for (std::size_t k = 0; k < 3; ++k) {
      owners_of_edge[std::minmax(v[k], v[(k + 1) % 3])].insert(binding.sphere_of_triangle[t]);
    }
  }
  std::size_t shared = 0;
  for (const auto& [edge, owners] : owners_of_edge) {
    if (owners.size() != 2) continue;
    ++shared;
    CHECK(std::binary_search(binding.ignored.begin(), binding.ignored.end(),
                             std::pair(*owners.begin(), *owners.rbegin())));
  }
  CHECK(shared > 100);
}

TEST_CASE("neighbours within a gap are counted along the mesh, not through space") {
  // A strip of four regions, three squares long each, flat or folded in the middle so that its ends lie on each other.
  for (const bool folded : {false, true}) {
    Mesh strip;
    std::vector<std::uint32_t> owner;
    for (int x = 0; x <= 12; ++x) {
      for (int y = 0; y <= 2; ++y) strip.positions.emplace_back(folded && x > 6 ? 12 - x : x, y, 0);
    }
    for (Index x = 0; x < 12; ++x) {
      for (Index y = 0; y < 2; ++y) {
        const Index v = 3 * x + y;
        strip.triangles.push_back({v, v + 3, v + 1});
        strip.triangles.push_back({v + 1, v + 3, v + 4});
        owner.insert(owner.end(), 2, x / 3);
      }
    }
    const auto within = [&](double gap) {
      SpherePairs pairs;
      add_neighbours(strip, owner, gap, pairs);
      return pairs;
    };
    const SpherePairs touching{{0, 1}, {1, 2}, {2, 3}}, next_but_one{{0, 1}, {0, 2}, {1, 2}, {1, 3}, {2, 3}};
    CHECK(within(0) == touching);
    CHECK(within(2.9) == touching);
    CHECK(within(3.1) == next_but_one);
    CHECK(within(5.9) == next_but_one);
    CHECK(within(6.1).size() == 6);
  }
}

TEST_CASE("a gap makes more neighbours of a body, and keeps those there are") {
  const Bake& bake = baked_human();
  BindSettings settings;
  settings.neighbour_gap = 0.03;
  const auto wide = bind_spheres(bake.character, bake.regions, bake.spheres, settings)->ignored;
  CHECK(std::includes(wide.begin(), wide.end(), bake.binding.ignored.begin(), bake.binding.ignored.end()));
  CHECK(wide.size() > bake.binding.ignored.size() + 10);
}

TEST_CASE("a detect quantile of 1 reaches the farthest centroid of the region") {
  const Bake& bake = baked_human();
  BindSettings settings;
  settings.detect_quantile = 1;
  const std::vector<BoundSphere> all = bind_spheres(bake.character, bake.regions, bake.spheres, settings)->spheres,
                                 most = bind_spheres(bake.character, bake.regions, bake.spheres, {})->spheres;
  for (std::size_t i = 0; i < all.size(); ++i) CHECK(all[i].detect_radius >= most[i].detect_radius);
}

TEST_CASE(
    "in profile paper every pair that is not ignored is reported only nearer than nine tenths of its rest distance") {
  const Bake& bake = paper_baked_human();
  const std::vector<BoundSphere>& spheres = bake.binding.spheres;
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> reach;
  for (const BoundPair& near : bake.binding.rest_detect) reach[{near.a, near.b}] = near.rest_scale;
  std::size_t at_rest = 0;
  for (std::uint32_t a = 0; a < spheres.size(); ++a) {
    for (std::uint32_t b = a + 1; b < spheres.size(); ++b) {
      const auto found = reach.find({a, b});
      if (std::binary_search(bake.binding.ignored.begin(), bake.binding.ignored.end(), std::pair(a, b))) {
        CHECK(found == reach.end());
        continue;
      }
      const double distance = (spheres[a].rest.center - spheres[b].rest.center).norm();
      const double sum = spheres[a].detect_radius + spheres[b].detect_radius;
      const double reported_below = found == reach.end() ? sum : found->second * sum;
      CHECK(reported_below == doctest::Approx(std::min(sum, 0.9 * distance)));
      at_rest += distance < sum ? 1u : 0u;
    }
  }
  CHECK(at_rest > 10);
}

TEST_CASE("a sphere in a spike beyond all triangles is carried from near its place, by weights that stay small") {
  Mesh mesh;
  std::vector<Index> triangles;
  // Rings of a cone's lower part: all centroids lie below the sphere.
  for (int i = 0; i < 24; ++i) {
    const double angle = 0.7 * i, z = 0.02 * i, r = 1 - z;
    for (const double turn : {0.0, 0.3, 0.15}) {
      mesh.positions.emplace_back(r * std::cos(angle + turn), r * std::sin(angle + turn), turn == 0.15 ? z + 0.1 : z);
    }
    const auto first = static_cast<Index>(3 * i);
    mesh.triangles.push_back({first, first + 1, first + 2});
    triangles.push_back(static_cast<Index>(i));
  }
  const FittedSphere spike{{Vec3(0, 0, 1.6), 0.2}, 0, -1, Side::kNone, Vec3::UnitZ(), true};
  REQUIRE(choose_pivots(mesh, triangles, spike, Vec3::UnitX(), RefitRule::kMoments, 8).empty());
  const std::vector<BoundPivot> pivots = choose_nearest_pivots(mesh, triangles, spike, Vec3::UnitX(), 8);
  REQUIRE(pivots.size() >= 4);
  double sum = 0, magnitudes = 0;
  Vec3 center = Vec3::Zero(), mean = Vec3::Zero();
  for (const BoundPivot& pivot : pivots) {
    sum += pivot.weight;
    magnitudes += std::abs(pivot.weight);
    center += pivot.weight * triangle_centroid(mesh, pivot.triangle);
    mean += triangle_centroid(mesh, pivot.triangle) / static_cast<double>(pivots.size());
  }
  CHECK(sum == doctest::Approx(1));
  CHECK(magnitudes <= 1.5 + 1e-9);
  CHECK((center - spike.ball.center).norm() < (mean - spike.ball.center).norm());
  // Drawn straight towards the pivots' mean.
  CHECK((center - mean).normalized().dot((spike.ball.center - mean).normalized()) > 1 - 1e-9);
}
