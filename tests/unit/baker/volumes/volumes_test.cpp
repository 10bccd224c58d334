// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <numbers>
#include <random>
#include <set>

#include "baked_human.h"
#include "baker/export/ignore_by_filter.h"
#include "baker/mesh/decompose.h"
#include "baker/volumes/bodies.h"
#include "baker/volumes/fit_body.h"
#include "baker/volumes/fit_volumes.h"
#include "baker/volumes/measure.h"

using namespace spherechain::baker;

namespace {

std::vector<Volume> some_volumes() {
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.8, 0.3, -0.2, 0.5).normalized();
  return {BallVolume{{0.1, 0.2, 0.3}, 0.4},
          ConeVolume{{0, 0, 0}, {0.5, 0.2, 0.1}, 0.3, 0.1},
          ConeVolume{{0, 0, 0}, {0.5, 0.2, 0.1}, 0.2, 0.2},
          ConeVolume{{0, 0, 0}, {0.1, 0, 0}, 0.3, 0.1},  // one end holds the other
          EllipsoidVolume{{0.1, 0, 0}, turn, {0.4, 0.2, 0.1}},
          BoxVolume{{0, 0.1, 0}, turn, {0.3, 0.2, 0.1}}};
}

Vec3 random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Vec3(normal(random), normal(random), normal(random)).normalized();
}

// Points all over a volume's surface: where rays from inside leave it, by bisection.
std::vector<Vec3> surface_points(const Volume& volume, int count, std::mt19937& random) {
  const Vec3 inside = (support(volume, Vec3::UnitX()) + support(volume, -Vec3::UnitX())) / 2;
  std::vector<Vec3> out;
  for (int i = 0; i < count; ++i) {
    const Vec3 direction = random_direction(random);
    double low = 0, high = 3;
    for (int step = 0; step < 40; ++step) {
      const double middle = (low + high) / 2;
      (signed_distance(volume, inside + middle * direction) <= 0 ? low : high) = middle;
    }
    out.push_back(inside + low * direction);
  }
  return out;
}

// A tube with two radii and round ends, sampled.
BodySkin skin_of(const Volume& volume, int count) {
  std::mt19937 random(5);
  BodySkin out;
  for (const Vec3& point : surface_points(volume, count, random)) out.samples.push_back({point, 1.0 / count});
  return out;
}

}  // namespace

TEST_CASE("a volume's farthest points are those of its surface, and its content is that of its points") {
  std::mt19937 random(1);
  for (const Volume& volume : some_volumes()) {
    CAPTURE(volume_name(volume));
    const std::vector<Vec3> surface = surface_points(volume, 2000, random);
    for (int i = 0; i < 50; ++i) {
      const Vec3 direction = random_direction(random);
      double farthest = -INFINITY;
      for (const Vec3& point : surface) farthest = std::max(farthest, direction.dot(point));
      CHECK(direction.dot(support(volume, direction)) == doctest::Approx(farthest).epsilon(0.02));
      CHECK(direction.dot(support(volume, direction)) >= farthest - 1e-9);
    }
    std::uniform_real_distribution<double> place(-1, 1);
    int inside = 0;
    constexpr int kPoints = 50000;
    for (int i = 0; i < kPoints; ++i) {
      inside += signed_distance(volume, {place(random), place(random), place(random)}) <= 0 ? 1 : 0;
    }
    CHECK(volume_of(volume) == doctest::Approx(8.0 * inside / kPoints).epsilon(0.08));
  }
}

TEST_CASE("two volumes overlap where a point is in both") {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(-0.9, 0.9);
  int overlaps = 0, close = 0;
  for (const Volume& a : some_volumes()) {
    for (const Volume& b : some_volumes()) {
      for (int i = 0; i < 8; ++i) {
        Eigen::Isometry3d at = Eigen::Isometry3d::Identity();
        at.linear() = turn_between(random_direction(random), random_direction(random)).matrix();
        at.translation() = Vec3(place(random), place(random), place(random));
        const Volume moved_b = moved(b, Affine(at));
        // Two convex volumes that overlap have a point of one's surface in the other, but where one holds the other.
        double least = INFINITY;
        for (const Vec3& one : surface_points(moved_b, 150, random)) least = std::min(least, signed_distance(a, one));
        for (const Vec3& one : surface_points(a, 150, random)) least = std::min(least, signed_distance(moved_b, one));
        if (std::abs(least) < 0.04) {
          ++close;
          continue;
        }
        const bool found = overlap(a, Eigen::Isometry3d::Identity(), b, at);
        CHECK(found == (least < 0));
        CHECK(found == overlap(b, at, a, Eigen::Isometry3d::Identity()));
        overlaps += found ? 1 : 0;
      }
    }
  }
  CHECK(overlaps > 20);
  CHECK(close < 120);
}

TEST_CASE("a volume is found again in samples of its surface") {
  const auto gap_of = [](VolumeShape shape, const Volume& volume) {
    return fit_body(shape, skin_of(volume, 300), 1).gap;
  };
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.8, 0.3, -0.2, 0.5).normalized();
  CHECK(gap_of(VolumeShape::kSpheres, BallVolume{{0.1, 0.2, 0.3}, 0.4}) < 1e-3);
  CHECK(gap_of(VolumeShape::kCones, ConeVolume{{0, 0, 0}, {0.5, 0.2, 0.1}, 0.2, 0.1}) < 1e-3);
  CHECK(gap_of(VolumeShape::kCapsules, ConeVolume{{0, 0, 0}, {0.5, 0.2, 0.1}, 0.2, 0.2}) < 1e-3);
  CHECK(gap_of(VolumeShape::kEllipsoids, EllipsoidVolume{{0.1, 0, 0}, turn, {0.4, 0.2, 0.15}}) < 2e-3);
  CHECK(gap_of(VolumeShape::kBoxes, BoxVolume{{0, 0.1, 0}, turn, {0.4, 0.2, 0.1}}) < 5e-3);
}

TEST_CASE("a tube that is open at its ends gets a capsule no longer than it is") {
  BodySkin tube;
  for (int i = 0; i < 20; ++i) {
    for (int k = 0; k < 12; ++k) {
      const double angle = 2 * std::numbers::pi * k / 12;
      tube.samples.push_back({{0.1 * std::cos(angle), 0.1 * std::sin(angle), i / 19.0}, 1});
    }
  }
  for (const Vec3& direction : reach_directions()) {
    double most = -INFINITY;
    for (const BodySample& sample : tube.samples) most = std::max(most, direction.dot(sample.point));
    tube.reach.push_back(most + 0.1);
  }
  const BodyFit fit = fit_body(VolumeShape::kCones, tube, 1);
  const auto& cone = std::get<ConeVolume>(fit.volumes.at(0));
  CHECK(std::min(cone.a.z(), cone.b.z()) > -0.03);
  CHECK(std::max(cone.a.z(), cone.b.z()) < 1.03);
  CHECK(cone.radius_a == doctest::Approx(0.1).epsilon(0.05));
  CHECK(cone.radius_b == doctest::Approx(0.1).epsilon(0.05));
}

TEST_CASE("a cup that is open at its wide end gets a cone that stays near it") {
  BodySkin cup;
  for (int i = 0; i < 20; ++i) {
    const double z = i / 95.0, radius = 0.1 + z;
    for (int k = 0; k < 16; ++k) {
      const double angle = 2 * std::numbers::pi * k / 16;
      cup.samples.push_back({{radius * std::cos(angle), radius * std::sin(angle), z}, radius});
    }
  }
  for (const Vec3& direction : reach_directions()) {
    double most = -INFINITY;
    for (const BodySample& sample : cup.samples) most = std::max(most, direction.dot(sample.point));
    cup.reach.push_back(most + 0.05);
  }
  const auto top = [](const BodySkin& skin) {
    return support(fit_body(VolumeShape::kCones, skin, 1).volumes.at(0), Vec3::UnitZ()).z();
  };
  const double bounded = top(cup);
  cup.reach.clear();
  CHECK(bounded < 0.75 * top(cup));
}

TEST_CASE("volumes of a human: never more than asked for, nearer to the skin the more there are" *
          doctest::test_suite("many bakes")) {
  const Bake& human = baked_human();
  const OpenAsset asset = open_asset_of(human);
  const double height = find_bodies(asset).height;
  Colliders cones;
  double before = INFINITY;
  for (const int at_most : {4, 16}) {
    cones = fit_volumes(asset, VolumeShape::kCones, at_most);
    const ColliderFit fit = measure_fit(asset, cones);
    CHECK(fit.volumes <= at_most);
    CHECK(fit.volumes >= at_most - 1);
    CHECK(fit.coverage > 0.85);
    CHECK(fit.gap_mean < before);
    before = fit.gap_mean;
  }
  CHECK(before < 0.01 * height);
  // Parts that intersect at rest are not tested, nor is a part against its parent.
  CHECK(overlapping(cones, at_rest(cones)).empty());
  for (std::size_t i = 0; i < cones.bodies.size(); ++i) {
    const int parent = cones.bodies[i].parent;
    if (parent < 0) continue;
    CHECK(std::any_of(cones.ignored.begin(), cones.ignored.end(), [&](const IgnoredBodies& pair) {
      return pair.a == parent && pair.b == static_cast<int>(i) && pair.reason == IgnoredReason::kAdjacent;
    }));
  }
}

TEST_CASE("fewer volumes than parts: both ends of limbs go, never the middle; spheres leave no part out" *
          doctest::test_suite("many bakes")) {
  const OpenAsset asset = open_asset_of(baked_human());
  const Colliders few = fit_volumes(asset, VolumeShape::kCones, 12);
  std::set<std::string> held;
  for (const ColliderBody& body : few.bodies) {
    if (body.held_by >= 0) held.insert(body.name);
  }
  CHECK(held == std::set<std::string>{"left foot", "left hand", "left shoulder", "neck", "right foot", "right hand",
                                      "right shoulder"});
  Colliders spheres = fit_volumes(asset, VolumeShape::kSpheres, 0);
  CHECK(measure_fit(asset, spheres).volumes <= static_cast<int>(asset->info().sphere_count));
  for (const ColliderBody& body : spheres.bodies) CHECK_MESSAGE(!body.volumes.empty(), body.name);
  // A part without its volumes is outside, and no other part is.
  for (ColliderBody& body : spheres.bodies) {
    if (body.name == "head") body.volumes.clear();
  }
  const ColliderFit headless = measure_fit(asset, spheres);
  for (std::size_t i = 0; i < spheres.bodies.size(); ++i) {
    CHECK_MESSAGE((headless.coverage_of_body[i] < 0.5) == (spheres.bodies[i].name == "head"), spheres.bodies[i].name);
  }
}

TEST_CASE("bodies that the filter saw idle are ignored, but those that stand for a part that needs a test") {
  Colliders colliders;
  for (const char* name : {"trunk", "arm", "leg", "hand"}) {  // the arm stands for the hand
    colliders.bodies.push_back({});
    colliders.bodies.back().name = name;
  }
  colliders.bodies[3].held_by = 1;
  colliders.ignored = {{0, 1, IgnoredReason::kAdjacent}, {0, 2, IgnoredReason::kRest}};
  PartFilter filter;
  filter.parts = {"hand", "leg", "arm", "trunk"};
  const auto ignored_with = [&](PairKind hand_leg, PairKind leg_arm, PairKind leg_trunk) {
    filter.pairs = {{{0, 1}, hand_leg, 0, 0, 1},         {{0, 2}, PairKind::kAdjacent, 0, 0, 1},
                    {{0, 3}, PairKind::kNever, 0, 0, 1}, {{1, 2}, leg_arm, 0, 0, 1},
                    {{1, 3}, leg_trunk, 0, 0, 1},        {{2, 3}, PairKind::kAdjacent, 0, 0, 1}};
    Colliders out = colliders;
    ignore_by_filter(filter, out);
    std::vector<std::array<int, 3>> pairs;
    for (const IgnoredBodies& pair : out.ignored) pairs.push_back({pair.a, pair.b, static_cast<int>(pair.reason)});
    return pairs;
  };
  using Pairs = std::vector<std::array<int, 3>>;
  constexpr int kAdjacent = 0, kRest = 1, kAlways = 2, kNever = 3;
  CHECK(ignored_with(PairKind::kNever, PairKind::kNever, PairKind::kRest) ==
        Pairs{{0, 1, kAdjacent}, {0, 2, kRest}, {1, 2, kNever}});
  CHECK(ignored_with(PairKind::kNever, PairKind::kAlways, PairKind::kAlways) ==
        Pairs{{0, 1, kAdjacent}, {0, 2, kAlways}, {1, 2, kAlways}});
  CHECK(ignored_with(PairKind::kSometimes, PairKind::kNever, PairKind::kNever) ==
        Pairs{{0, 1, kAdjacent}, {0, 2, kNever}});
}
