// SPDX-License-Identifier: GPL-3.0-or-later
// The rival: capsules on bones, where their shape and distance are known, and on the human.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "baked_human.h"
#include "baker/motion/poses.h"
#include "capsules.h"
#include "human.h"
#include "temporary_folder.h"

using namespace spherechain::baker;
using spherechain::Pair;

namespace {

// The least over many points of both axes.
double sampled_gap(const Capsule& a, const Capsule& b) {
  double least = 1e9;
  for (int i = 0; i <= 400; ++i) {
    for (int k = 0; k <= 400; ++k) {
      const Vec3 p = a.from + i / 400.0 * (a.to - a.from), q = b.from + k / 400.0 * (b.to - b.from);
      least = std::min(least, (p - q).norm());
    }
  }
  return least - a.radius - b.radius;
}

struct Ragdoll {
  TemporaryFolder folder;
  AnimatedAsset animated;
  TruthSurface surface;
  CapsuleRagdoll ragdoll;

  explicit Ragdoll(const char* pose)
      : animated(
            folder.write("human.sphc", std::string(baked_human().asset.begin(), baked_human().asset.end())).string(),
            kHumanFile, {std::string(SPHERECHAIN_SAMPLES) + "/poses/" + pose, {}, {}}, {2, 30}),
        surface(surface_of(animated.asset(), animated.character())),
        ragdoll(animated, surface, 0.9) {}
};

}  // namespace

TEST_CASE("a capsule around a tube has the tube's axis, radius and length") {
  const Vec3 axis = Vec3(1, 2, -2) / 3, side = Vec3(2, 1, 2) / 3, other = axis.cross(side), middle(5, 6, 7);
  std::vector<Vec3> points;
  for (int ring = -50; ring <= 50; ++ring) {
    for (int k = 0; k < 12; ++k) {
      const double angle = k * std::numbers::pi / 6;
      points.push_back(middle + ring / 10.0 * axis + 0.8 * (std::cos(angle) * side + std::sin(angle) * other));
    }
  }
  const Capsule capsule = fit_capsule(points, std::vector<double>(points.size(), 0.25), 0.6);
  CHECK(capsule.radius == doctest::Approx(0.8));
  const Vec3 along = capsule.to - capsule.from;
  CHECK(along.norm() == doctest::Approx(10 - 2 * 0.8));
  CHECK(along.cross(axis).norm() < 1e-9);
  CHECK(((capsule.from + capsule.to) / 2 - middle).norm() < 1e-9);
}

TEST_CASE("a capsule's radius leaves out the far points, by their area") {
  // Nine tenths of the points, but a tenth of the area, are far from the axis.
  std::vector<Vec3> points;
  std::vector<double> areas;
  for (int x = -100; x <= 100; ++x) {
    points.push_back({x / 10.0, 0.1, 0});
    points.push_back({x / 10.0, -0.1, 0});
    areas.insert(areas.end(), 2, 9);
    for (int k = 0; k < 9; ++k) {
      points.push_back({x / 10.0, 0, 0.5});
      points.push_back({x / 10.0, 0, -0.5});
      areas.insert(areas.end(), 2, 1.0 / 9);
    }
  }
  CHECK(fit_capsule(points, areas, 0.6).radius == doctest::Approx(0.1));
  CHECK(fit_capsule(points, areas, 0.95).radius > 0.4);
}

TEST_CASE("the gap between capsules is that between their axes less the radii") {
  std::mt19937 bits(3);
  const auto coordinate = [&] { return static_cast<double>(bits() % 2001) / 1000 - 1; };
  for (int i = 0; i < 20; ++i) {
    const Capsule a{{coordinate(), coordinate(), coordinate()}, {coordinate(), coordinate(), coordinate()}, 0.1},
        b{{coordinate(), coordinate(), coordinate()}, {coordinate(), coordinate(), coordinate()}, 0.2};
    CHECK(gap(a, b) == doctest::Approx(sampled_gap(a, b)).epsilon(0.02));
    CHECK(gap(a, b) == doctest::Approx(gap(b, a)));
  }
  const Capsule ball{{0, 0, 0}, {0, 0, 0}, 1}, beside{{3, -1, 0}, {3, 1, 0}, 1}, parallel{{5, 0, 0}, {5, 4, 0}, 0.5};
  CHECK(gap(ball, beside) == doctest::Approx(1));
  CHECK(gap(beside, parallel) == doctest::Approx(0.5));
}

TEST_CASE("the human's capsules touch in no rest pose, and hands on hips bring them together") {
  const Ragdoll human("hands_on_hips.json");
  CHECK(human.ragdoll.capsules().size() > 15);
  std::size_t owned = 0;
  for (const std::vector<Index>& places : human.ragdoll.surface().of_sphere) owned += places.size();
  CHECK(owned == human.surface.corners.size());
  CHECK(human.ragdoll.pairs(human.animated.deformation(0)).empty());
  bool overlap = false;
  for (const Capsule& a : human.ragdoll.capsules()) {
    for (const Capsule& b : human.ragdoll.capsules()) overlap = overlap || (&a != &b && gap(a, b) < 0);
  }
  CHECK(overlap);
  const std::vector<Pair> pairs = human.ragdoll.pairs(human.animated.deformation(1));
  CHECK(!pairs.empty());
  for (const Pair& pair : pairs) CHECK(!human.ragdoll.is_ignored(pair.a, pair.b));
}

TEST_CASE("the spheres' true pairs keep their number when they are sorted by capsules") {
  const Ragdoll human("hands_on_hips.json");
  const std::vector<Index>& first = human.ragdoll.surface().of_sphere[0];
  const std::vector<Index>& second = human.ragdoll.surface().of_sphere[1];
  const auto pair_of = [&](Index a, Index b) {
    return Pair{std::min(human.surface.source_triangle[a], human.surface.source_triangle[b]),
                std::max(human.surface.source_triangle[a], human.surface.source_triangle[b])};
  };
  FrameTruth truth;
  truth.pairs = {pair_of(first[0], second[0]), pair_of(first[1], second[0]), pair_of(first[0], first[1])};
  const FrameTruth sorted = human.ragdoll.by_capsules(truth);
  CHECK(sorted.pairs == truth.pairs);
  REQUIRE(sorted.contacts.size() == 2);
  CHECK(sorted.contacts[0].spheres == Pair{0, 0});
  CHECK(sorted.contacts[0].triangles.size() == 1);
  CHECK(sorted.contacts[1].spheres == Pair{0, 1});
  CHECK(sorted.contacts[1].triangles.size() == 2);
}
