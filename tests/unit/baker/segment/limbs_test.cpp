// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies of any number of limbs, by their shape and by their rig.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "baker/pipeline/pipeline.h"
#include "baker/segment/limb_trace.h"
#include "closed_shapes.h"
#include "creatures.h"
#include "human.h"

using namespace spherechain::baker;

namespace {

Attempt<Regions> try_to_segment(const SourceMesh& source, const SegmentSettings& settings) {
  const Character character = build_character(source, "creature.obj");
  return segment_by_shape(character, character.largest_piece, settings);
}

Regions segmented(const SourceMesh& source, const SegmentSettings& settings = {}) {
  return *try_to_segment(source, settings);
}

std::vector<std::string> names(const Regions& regions) {
  std::vector<std::string> all;
  for (std::size_t i = 0; i < regions.count(); ++i) all.push_back(regions.name(i));
  return all;
}

const SourceMesh& quadruped() {
  static const SourceMesh mesh = melt(quadruped_tubes(), 0.035);
  return mesh;
}

double distance_to_axes(const std::vector<Tube>& tubes, const Vec3& p) {
  double least = 1e9;
  for (const Tube& tube : tubes) {
    const Vec3 axis = tube.to - tube.from;
    const double f = std::clamp((p - tube.from).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (p - tube.from - f * axis).norm());
  }
  return least;
}

std::string reason_against(const SourceMesh& source, const SegmentSettings& settings) {
  const Attempt<Regions> regions = try_to_segment(source, settings);
  return regions ? "no reason" : regions.reason().what;
}

std::string reason_against(const SourceMesh& source, BodyKind body) {
  SegmentSettings settings;
  settings.body = body;
  return reason_against(source, settings);
}

const std::vector<std::string> kQuadruped{"left_foreleg", "right_foreleg", "left_hindleg", "right_hindleg",
                                          "neck",         "tail",          "torso"};

}  // namespace

TEST_CASE("a quadruped without a rig has forelegs, hind legs, neck, tail and trunk, and left is left" *
          doctest::test_suite("many bakes")) {
  const Regions regions = segmented(quadruped());
  REQUIRE(names(regions) == kQuadruped);
  CHECK(regions.frame.left.dot(Vec3::UnitX()) > 0.999);
  CHECK(regions.frame.up.dot(Vec3::UnitZ()) > 0.98);  // the way from hip to chest
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 paw = regions.limbs[i].line.points().back();
    CHECK((paw.x() > 0) == (i % 2 == 0));
    CHECK((paw.z() > 0) == (i < 2));
    CHECK(paw.y() < 0.15);
  }
  CHECK(regions.limbs[4].line.points().back().z() > 0.7);
  CHECK(regions.limbs[5].line.points().back().z() < -0.8);
}

TEST_CASE("a quadruped's spheres follow the tubes it is made of" * doctest::test_suite("many bakes")) {
  const Regions regions = segmented(quadruped());
  const Spheres spheres = *fit_spheres(regions, {});
  for (std::size_t i = 0; i < spheres.spheres.size(); ++i) {
    const FittedSphere& sphere = spheres.spheres[i];
    const double off = distance_to_axes(quadruped_tubes(), sphere.ball.center);
    // Where tubes meet, a sphere stands in their common inside; the trunk's top level in the bulge below the neck.
    const double limit = sphere.region == regions.torso_region() ? 0.1 : 0.06;
    CHECK_MESSAGE(off < limit, fmt::format("sphere {} of the {}: {:.3f}", i, regions.name(sphere.region), off));
    CHECK(sphere.ball.radius > 0.01);
    CHECK(sphere.ball.radius < 0.25);
  }
  for (std::size_t region = 0; region < 6; ++region) CHECK(spheres.of_region[region].size() >= 4);
  std::vector<LimbPlace> limbs;
  for (const Limb& limb : regions.limbs)
    limbs.push_back({static_cast<std::uint8_t>(limbs.size()), limb.side, limb.along});
  CHECK(build_chains(spheres, limbs).chains.size() == 6 * 5 / 2);
}

TEST_CASE("a straight tail ends where the trunk begins, however deep in it its branch starts") {
  // Between -0.26 and -0.12 the tail widens into the trunk, and all rays of a section grow alike: none escapes.
  const SourceMesh source = melt({{{0, 0, 0}, {0, 0, 1}, 0.2, 0.2},
                                  {{0, 0, -0.12}, {0, 0, -0.26}, 0.14, 0.05},
                                  {{0, 0, -0.26}, {0, 0, -0.9}, 0.05, 0.03}},
                                 0.02);
  const Mesh mesh{source.positions, source.triangles};
  const BodyFrame frame{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ(), 1};
  for (const double start : {0.0, 0.2, 0.4}) {
    const Polyline branch({Vec3(0, 0, start), Vec3(0, 0, -0.85)});
    const Attempt<LimbTrace> trace = trace_limb(SurfaceQuery(mesh), branch, LimbEnd::kTip, frame, 32, "tail");
    REQUIRE(trace);
    CHECK(trace->line.points().front().z() < -0.18);
    CHECK(trace->line.points().front().z() > -0.32);
  }
}

TEST_CASE("a quadruped is the same in other units, turned, and with its triangles in another order" *
          doctest::test_suite("many bakes")) {
  const Regions usual = segmented(quadruped());
  SourceMesh turned = quadruped();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  for (Vec3& p : turned.positions) p = 100 * (turn * p) + Vec3(30, -20, 7);
  std::reverse(turned.triangles.begin(), turned.triangles.end());
  const Regions other = segmented(turned);
  REQUIRE(names(other) == names(usual));
  std::size_t same = 0;
  const std::size_t count = usual.of_triangle.size();
  for (std::size_t t = 0; t < count; ++t) same += usual.of_triangle[t] == other.of_triangle[count - 1 - t] ? 1U : 0U;
  CHECK(static_cast<double>(same) > 0.98 * static_cast<double>(count));
  CHECK(other.frame.left.dot(turn * usual.frame.left) > 0.999);
  CHECK(std::abs(other.frame.height / usual.frame.height / 100 - 1) < 0.01);
}

TEST_CASE("a facing direction turns a quadruped round: head is tail and left is right" *
          doctest::test_suite("many bakes")) {
  SegmentSettings settings;
  settings.facing = -Vec3::UnitZ();
  const Regions turned = segmented(quadruped(), settings);
  CHECK(turned.frame.left.dot(Vec3::UnitX()) < -0.999);
  CHECK(turned.limbs[0].line.points().back().z() < 0);
  settings.facing = Vec3::UnitX();
  CHECK(reason_against(quadruped(), settings).find("facing direction") != std::string::npos);
}

TEST_CASE("what the body is taken for can be said: a human goes on all fours, and a quadruped is no biped" *
          doctest::test_suite("many bakes")) {
  CHECK(reason_against(quadruped(), BodyKind::kBiped).find("biped") != std::string::npos);
  CHECK(reason_against(melt(six_legged_tubes(), 0.045), BodyKind::kQuadruped).find("quadruped") != std::string::npos);
  SegmentSettings settings;
  settings.body = BodyKind::kQuadruped;
  const Regions regions = *segment_by_shape(human().character, human().regions.body, settings);
  REQUIRE(regions.limbs.size() >= 4);
  CHECK(regions.name(0) == "left_foreleg");
  CHECK(regions.name(3) == "right_hindleg");
}

TEST_CASE("a six-legged creature has three pairs from the front, each where it leaves the trunk" *
          doctest::test_suite("many bakes")) {
  const SourceMesh mesh = melt(six_legged_tubes(), 0.045);
  const Regions regions = segmented(mesh);
  REQUIRE(names(regions) == std::vector<std::string>{"left_leg_1", "right_leg_1", "left_leg_2", "right_leg_2",
                                                     "left_leg_3", "right_leg_3", "torso"});
  constexpr std::array<double, 3> kAlong{1, 0.5, 0};
  for (std::size_t i = 0; i < 6; ++i) {
    const Vec3 foot = regions.limbs[i].line.points().back();
    CHECK((foot.x() > 0) == (i % 2 == 0));
    CHECK(std::abs(foot.z() - 1.4 * (0.42 - 0.42 * static_cast<double>(i / 2))) < 0.1);
    CHECK(std::abs(regions.limbs[i].along - kAlong[i / 2]) < 0.1);
  }
  const Spheres spheres = *fit_spheres(regions, {});
  for (const FittedSphere& sphere : spheres.spheres) {
    CHECK(distance_to_axes(six_legged_tubes(), sphere.ball.center) < 0.05);
  }
}

TEST_CASE("a snake is one tubular chain from the tail's tip to the head" * doctest::test_suite("many bakes")) {
  const SourceMesh mesh = melt(snake_tubes(), 0.03);
  const Regions regions = segmented(mesh);
  REQUIRE(names(regions) == std::vector<std::string>{"body"});
  CHECK_FALSE(regions.has_torso);
  const Spheres spheres = *fit_spheres(regions, {});
  REQUIRE(spheres.spheres.size() > 10);
  for (std::size_t i = 0; i < spheres.spheres.size(); ++i) {
    CHECK(distance_to_axes(snake_tubes(), spheres.spheres[i].ball.center) < 0.02);
    if (i > 0) CHECK(spheres.spheres[i].ball.center.z() > spheres.spheres[i - 1].ball.center.z());
  }
  const Chains chains = build_chains(spheres, {{0, Side::kNone, 0}});
  REQUIRE(chains.chains.size() == 1);
  CHECK(chains.chains[0].spheres.size() == spheres.spheres.size());

  SegmentSettings settings;
  settings.facing = -Vec3::UnitZ();
  CHECK(segmented(mesh, settings).frame.up.z() < -0.5);
  settings.facing = Vec3::UnitY();
  CHECK(reason_against(mesh, settings).find("facing direction") != std::string::npos);
}

TEST_CASE("a ring is walked round once, and a ball is no character" * doctest::test_suite("many bakes")) {
  std::vector<Tube> ring;
  const auto at = [](int i) { return Vec3(std::cos(0.4 * i), 0, std::sin(0.4 * i)); };
  for (int i = 0; i < 16; ++i) ring.push_back({at(i), at(i + 1), 0.1, 0.1});
  if (const Attempt<Regions> regions = try_to_segment(melt(ring, 0.05), {})) {
    for (const Limb& limb : regions->limbs) CHECK(limb.line.length() < 4 * 6.3);
  }
  CHECK(reason_against(ball_mesh(24), BodyKind::kUnknown).find("ball") != std::string::npos);
}

TEST_CASE("a human with a long tail keeps arms and legs, and the tail is a limb" * doctest::test_suite("many bakes")) {
  std::vector<Tube> tubes{{{0, 1.0, 0}, {0, 1.4, 0}, 0.15, 0.15},     // trunk
                          {{0, 1.45, 0}, {0, 1.62, 0}, 0.06, 0.06},   // neck
                          {{0, 1.68, 0}, {0, 1.76, 0.01}, 0.1, 0.1},  // head
                          {{0, 0.95, -0.12}, {0, 0.5, -0.6}, 0.05, 0.04}};
  for (const double side : {1.0, -1.0}) {
    tubes.push_back({{side * 0.18, 1.42, 0}, {side * 0.75, 1.15, 0}, 0.06, 0.04});
    tubes.push_back({{side * 0.1, 0.92, 0}, {side * 0.16, 0.08, 0}, 0.08, 0.05});
    tubes.push_back({{side * 0.16, 0.06, 0}, {side * 0.16, 0.05, 0.16}, 0.05, 0.04});
  }
  const auto melted = melt(tubes, 0.045);
  const Regions regions = segmented(melted);
  REQUIRE(names(regions) ==
          std::vector<std::string>{"left_arm", "right_arm", "left_leg", "right_leg", "tail", "torso"});
  CHECK(regions.frame.forward.dot(Vec3::UnitZ()) > 0.98);
  CHECK(regions.limbs[0].line.points().back().x() > 0.5);
  CHECK(regions.limbs[4].line.points().back().z() < -0.4);

  SegmentSettings settings;
  settings.facing = -Vec3::UnitZ();
  CHECK(segmented(melted, settings).frame.forward.dot(Vec3::UnitZ()) < -0.98);
  settings.facing = Vec3::UnitX();
  CHECK(reason_against(melted, settings).find("facing direction") != std::string::npos);
  // Nor is it said of one without head and tail that these are missing.
  tubes.erase(tubes.begin() + 1, tubes.begin() + 4);
  CHECK(reason_against(melt(tubes, 0.045), settings).find("facing direction") != std::string::npos);
}

TEST_CASE("a rigged beast in open pieces bakes with four legs and a tail, and left is left") {
  // Debian's assimp-testmodels; z is up, and it looks along -y.
  const BakeSettings as_quadruped = make_settings("balanced", R"({"body": "quadruped"})", "test");
  const Bake result = bake("/usr/share/assimp/models/X/Testwuson.X", as_quadruped, {});
  REQUIRE(names(result.regions) ==
          std::vector<std::string>{"left_foreleg", "right_foreleg", "left_hindleg", "right_hindleg", "tail", "torso"});
  for (std::size_t region = 0; region < result.spheres.of_region.size(); ++region) {
    CHECK(result.spheres.of_region[region].size() >= 4);
  }
  const auto mean_left = [&](std::uint8_t region) {
    double sum = 0;
    for (const std::uint32_t i : result.spheres.of_region[region]) {
      sum += (result.spheres.spheres[i].ball.center - result.regions.frame.origin).dot(result.regions.frame.left);
    }
    return sum / static_cast<double>(result.spheres.of_region[region].size());
  };
  CHECK(mean_left(0) > 0.1);
  CHECK(std::abs(mean_left(0) + mean_left(1)) < 0.03);
  CHECK(std::abs(mean_left(2) + mean_left(3)) < 0.03);
  CHECK(std::abs(mean_left(4)) < 0.03);
}
