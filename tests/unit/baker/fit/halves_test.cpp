// SPDX-License-Identifier: GPL-3.0-or-later
// The fit for any body: parts that follow the bones, halved where they fit worst, chains along their tree.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "baker/fit/piece.h"
#include "baker/mesh/error.h"
#include "baker/pipeline/pipeline.h"
#include "baker/segment/by_bones.h"
#include "baker/segment/part_tree.h"
#include "creatures.h"
#include "human.h"
#include "two_shapes.h"

using namespace spherechain::baker;

namespace {

double distance_to(const Tube& tube, const Vec3& p) {
  const Vec3 axis = tube.to - tube.from;
  return (p - tube.from - std::clamp((p - tube.from).dot(axis) / axis.squaredNorm(), 0.0, 1.0) * axis).norm();
}

struct Hand {
  std::vector<Tube> tubes{{{0, 0, 0}, {0, 0.3, 0}, 0.2, 0.22}};  // a palm, then two bones a finger
  std::vector<std::string> names{"palm"};
  std::vector<int> parents{-1};
};

// Five fingers, mirrored left and right of the middle one; each vertex follows the tube next to it.
Hand hand() {
  Hand made;
  for (int finger = 0; finger < 5; ++finger) {
    const double x = 0.2 * (finger - 2);
    const Vec3 root(0.6 * x, 0.4, 0), middle(x, 0.8, 0), tip(1.2 * x, 1.1, 0);
    const int first = static_cast<int>(made.tubes.size());
    made.tubes.push_back({root, middle, 0.06, 0.05});
    made.tubes.push_back({middle, tip, 0.05, 0.04});
    for (const char* bone : {"a", "b"}) made.names.push_back("finger" + std::to_string(finger) + bone);
    made.parents.insert(made.parents.end(), {0, first});
  }
  return made;
}

SourceMesh mesh_of(const Hand& hand) {
  SourceMesh mesh = melt(hand.tubes, 0.045);
  for (std::size_t i = 0; i < hand.tubes.size(); ++i) {
    Node node;
    node.name = hand.names[i];
    node.parent = hand.parents[i];
    node.translation = hand.tubes[i].from;
    if (node.parent >= 0) node.translation -= hand.tubes[static_cast<std::size_t>(node.parent)].from;
    node.local.translation() = node.translation;
    Affine inverse_bind = Affine::Identity();
    inverse_bind.translation() = -hand.tubes[i].from;
    mesh.rig.nodes.push_back(node);
    mesh.rig.bones.push_back({static_cast<Index>(i), inverse_bind});
  }
  for (const Vec3& p : mesh.positions) {
    const auto nearer = [&](const Tube& a, const Tube& b) { return distance_to(a, p) < distance_to(b, p); };
    const auto nearest = std::min_element(hand.tubes.begin(), hand.tubes.end(), nearer);
    VertexWeights weights;
    weights.joint[0] = static_cast<Index>(nearest - hand.tubes.begin());
    weights.weight[0] = 1;
    mesh.rig.weights.push_back(weights);
  }
  return mesh;
}

FittedCharacter fitted(const SourceMesh& mesh, const BakeSettings& settings = {}) {
  return fit_character(build_character(mesh, "hand.glb"), {}, settings);
}

// Checks the rules that every such fit follows.
void check_fit(const FittedCharacter& fit, std::size_t most) {
  const Regions& regions = fit.segmentation.regions;
  const Mesh& skin = fit.segmentation.regions.body.mesh;
  REQUIRE(regions.is_tree());
  REQUIRE(regions.parents.size() == regions.count());
  for (std::uint8_t region = 0; region < regions.count(); ++region) {
    std::uint8_t above = region;
    for (std::size_t i = 0; i < regions.count(); ++i) above = regions.parents[above];
    CHECK(above == regions.torso_region());
    CHECK_FALSE(fit.spheres.of_region[region].empty());
  }
  CHECK(fit.spheres.spheres.size() <= most);
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    CHECK(fit.spheres.spheres[fit.spheres.of_skin[t]].region == regions.of_skin[t]);
  }
}

const FittedCharacter& fitted_hand() {
  static const FittedCharacter fit = fitted(mesh_of(hand()));
  return fit;
}

}  // namespace

TEST_CASE("a hand that the march has no limbs for is fitted by its bones: each finger follows its own" *
          doctest::test_suite("many bakes")) {
  const Hand made = hand();
  const FittedCharacter& fit = fitted_hand();
  check_fit(fit, kHalvedSpheresMax);
  CHECK(fit.quality.grade() == FitGrade::kGood);
  const Regions& regions = fit.segmentation.regions;
  REQUIRE(regions.count() == made.tubes.size());
  CHECK(regions.torso_name == "palm");
  const Mesh& skin = fit.segmentation.regions.body.mesh;
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < made.tubes.size(); ++i) {
      const Vec3 p = triangle_centroid(skin, t);
      if (distance_to(made.tubes[i], p) < distance_to(made.tubes[nearest], p) - 0.02) nearest = i;
    }
    const auto bone = static_cast<std::size_t>(
        std::find(made.names.begin(), made.names.end(), regions.name(regions.of_skin[t])) - made.names.begin());
    const Vec3 p = triangle_centroid(skin, t);
    CHECK(distance_to(made.tubes[bone], p) < distance_to(made.tubes[nearest], p) + 0.04);
  }
}

TEST_CASE("a limit on the spheres is kept, few or many, and more of them fit closer" *
          doctest::test_suite("many bakes")) {
  const SourceMesh mesh = mesh_of(hand());
  double last = 1;
  for (const int limit : {8, 200}) {
    CAPTURE(limit);
    BakeSettings settings;
    settings.fit.spheres = limit;
    const FittedCharacter fit = fitted(mesh, settings);
    check_fit(fit, static_cast<std::size_t>(limit));
    CHECK(fit.quality.distance_mean < last);
    last = fit.quality.distance_mean;
  }
}

TEST_CASE("mirrored parts have as many spheres" * doctest::test_suite("many bakes")) {
  const FittedCharacter& fit = fitted_hand();
  const auto spheres_of = [&](const std::string& name) {
    for (std::size_t region = 0; region < fit.segmentation.regions.count(); ++region) {
      if (fit.segmentation.regions.name(region) == name) return fit.spheres.of_region[region].size();
    }
    return std::size_t{0};
  };
  for (const char* bone : {"a", "b"}) {
    CHECK(spheres_of("finger0" + std::string(bone)) == spheres_of("finger4" + std::string(bone)));
    CHECK(spheres_of("finger1" + std::string(bone)) == spheres_of("finger3" + std::string(bone)));
  }
}

TEST_CASE("a part too small for a sphere of its own joins the one above it" * doctest::test_suite("many bakes")) {
  Hand made = hand();
  SourceMesh mesh = mesh_of(made);
  // One triangle of the last finger's tip hangs on a ring of its own.
  Node ring;
  ring.name = "ring";
  ring.parent = static_cast<int>(made.tubes.size()) - 1;
  mesh.rig.nodes.push_back(ring);
  mesh.rig.bones.push_back({static_cast<Index>(made.tubes.size()), Affine::Identity()});
  for (const Triangle& triangle : mesh.triangles) {
    if (mesh.rig.weights[triangle[0]].joint[0] + 1 != made.tubes.size()) continue;
    for (const Index v : triangle) mesh.rig.weights[v].joint[0] = static_cast<Index>(made.tubes.size());
    break;
  }
  const FittedCharacter fit = fitted(mesh);
  CHECK(fit.segmentation.regions.count() == made.tubes.size());
  check_fit(fit, kHalvedSpheresMax);
}

TEST_CASE("what nothing moves is cut in pieces that hang together; so is a body without bones" *
          doctest::test_suite("many bakes")) {
  const Hand made = hand();
  SourceMesh mesh = mesh_of(made);
  for (VertexWeights& weights : mesh.rig.weights) {
    if (weights.joint[0] == 0) weights = {};
  }
  check_fit(fitted(mesh), kHalvedSpheresMax);
  mesh.rig = {};
  const FittedCharacter still = fitted(mesh);
  check_fit(still, kHalvedSpheresMax);
  CHECK(still.quality.grade() != FitGrade::kPoor);
}

TEST_CASE("two cubes are not wrapped: they have too few triangles for limbs") {
  const Shape cube = box(1, 1, 1);
  SourceMesh cubes;
  for (const double x : {0.0, 2.4}) {
    const auto first = static_cast<Index>(cubes.positions.size());
    for (const Vec3& p : cube.positions) cubes.positions.push_back(p + Vec3(x, 0, 0));
    for (const auto& t : cube.triangles) cubes.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  for (const PassedOver& other : fitted(cubes).segmentation.choice.passed_over) {
    CHECK(other.strategy.find("alpha") == std::string::npos);
  }
}

TEST_CASE("a body of few triangles bakes: two in a plane, a bone with a single one; one alone cannot carry a sphere") {
  SourceMesh one;
  one.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  one.triangles = {{0, 1, 2}};
  CHECK_THROWS_WITH_AS(fitted(one), doctest::Contains("the skin is too small"), Error);
  SourceMesh two = one;
  two.positions.insert(two.positions.end(), {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
  two.triangles.push_back({3, 4, 5});
  CHECK(fitted(two).spheres.spheres.size() >= 1);
  Node root, child;
  root.name = "same";
  child.name = "same";
  child.parent = 0;
  two.rig.nodes = {root, child};
  two.rig.bones = {{0, Affine::Identity()}, {1, Affine::Identity()}};
  two.rig.weights.resize(6);
  for (Index v = 0; v < 6; ++v) {
    two.rig.weights[v].joint[0] = v < 3 ? 0 : 1;
    two.rig.weights[v].weight[0] = 1;
  }
  const FittedCharacter fit = fitted(two);
  REQUIRE(fit.segmentation.regions.count() == 2);
  CHECK(fit.segmentation.regions.name(0) != fit.segmentation.regions.name(1));
}

TEST_CASE("along a tree of parts every two spheres of different leaves share a chain" *
          doctest::test_suite("many bakes")) {
  const FittedCharacter& fit = fitted_hand();
  const std::vector<std::uint8_t>& parents = fit.segmentation.regions.parents;
  const Chains chains = build_tree_chains(fit.spheres, parents);
  CHECK(chains.chains.size() == 5 * 4 / 2);
  std::set<std::pair<std::uint32_t, std::uint32_t>> shared;
  for (const Chain& chain : chains.chains) {
    CHECK(std::set<std::uint32_t>(chain.spheres.begin(), chain.spheres.end()).size() == chain.spheres.size());
    for (const std::uint32_t a : chain.spheres) {
      for (const std::uint32_t b : chain.spheres) shared.emplace(a, b);
    }
  }
  const std::size_t n = fit.spheres.spheres.size();
  CHECK(shared.size() == n * n);
}

TEST_CASE("limbs that are kept have the march's spheres, and the rest of the body follows its bones") {
  FittedCharacter fit;
  const Character character = import_character(kModels / "X/Testwuson.X");  // a wolf
  const Roles roles = find_roles(character.rig, character.source_positions, {}, BodyKind::kUnknown);
  const Attempt<Segmentation> found = segment_character(character, roles, {}, Wraps::kUnmoved);
  REQUIRE(found);
  const Attempt<Spheres> march = fit_spheres(found->regions, {});
  REQUIRE(march);
  std::vector<bool> kept(found->regions.count(), true);
  kept[found->regions.torso_region()] = false;
  MixedRegions mixed = segment_rest_by_bones(character, found->regions, kept, roles, 40);
  fit.segmentation.regions = mixed.regions;
  fit.spheres = fit_halves(character, mixed.regions, {}, {&*march, mixed.kept});
  const Attempt<Binding> binding = bind_spheres(character, mixed.regions, fit.spheres, {});
  REQUIRE(binding);
  fit.binding = *binding;
  check_fit(fit, kHalvedSpheresMax);
  const Regions& regions = fit.segmentation.regions;
  const Mesh& skin = character.skin;
  std::set<std::string> legs;
  for (std::size_t region = 0; region < regions.count(); ++region) {
    const std::vector<std::uint32_t>& spheres = fit.spheres.of_region[region];
    if (regions.is_by_bones(region)) {
      CHECK_FALSE(regions.name(region).starts_with("left_"));
      continue;
    }
    const Limb& limb = regions.limbs[region];
    if (limb.side != Side::kNone) legs.insert(limb.name);
    // The paper's chain: along the limb from its start, and neighbours one after another.
    for (std::size_t i = 1; i < spheres.size(); ++i) {
      const auto along = [&](std::uint32_t sphere) {
        return limb.line.closest(fit.spheres.spheres[sphere].ball.center);
      };
      CHECK(along(spheres[i - 1]) <= along(spheres[i]));
      const auto link = std::minmax(spheres[i - 1], spheres[i]);
      CHECK(std::binary_search(fit.spheres.links.begin(), fit.spheres.links.end(),
                               std::pair<std::uint32_t, std::uint32_t>(link)));
    }
  }
  CHECK(legs == std::set<std::string>{"left_foreleg", "right_foreleg", "left_hindleg", "right_hindleg"});
  // A bone with most of its skin on a kept leg has all of it there.
  const std::vector<int> nodes = heaviest_nodes(character);
  std::map<int, std::map<std::uint8_t, double>> areas;
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    CHECK(regions.of_skin[t] == fit.spheres.spheres[fit.binding.sphere_of_triangle[t]].region);
    areas[nodes[t]][regions.of_skin[t]] += triangle_area(skin, t);
  }
  for (const auto& [node, of_region] : areas) {
    const auto most = std::max_element(of_region.begin(), of_region.end(),
                                       [](const auto& a, const auto& b) { return a.second < b.second; });
    CAPTURE(node);
    if (!regions.is_by_bones(most->first)) CHECK(of_region.size() == 1);
  }
}

// A bar of twelve triangles, as long as it is, moved by one bone.
void add_bar(SourceMesh& mesh, const Vec3& low, const Vec3& high, Index bone) {
  const auto first = static_cast<Index>(mesh.positions.size());
  for (int corner = 0; corner < 8; ++corner) {
    mesh.positions.emplace_back(corner & 1 ? high.x() : low.x(), corner & 2 ? high.y() : low.y(),
                                corner & 4 ? high.z() : low.z());
    VertexWeights weights;
    weights.joint[0] = bone;
    weights.weight[0] = 1;
    mesh.rig.weights.push_back(weights);
  }
  for (const Triangle& t : {Triangle{0, 2, 1}, Triangle{1, 2, 3}, Triangle{4, 5, 6}, Triangle{5, 7, 6},
                            Triangle{0, 1, 4}, Triangle{1, 5, 4}, Triangle{2, 6, 3}, Triangle{3, 6, 7},
                            Triangle{0, 4, 2}, Triangle{2, 4, 6}, Triangle{1, 3, 5}, Triangle{3, 7, 5}}) {
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
}

// Two bars side by side, a bone each: fingers of few, long triangles.
SourceMesh two_bars() {
  SourceMesh mesh;
  add_bar(mesh, {0, 0, 0}, {0.1, 1, 0.1}, 0);
  add_bar(mesh, {0.12, 0, 0}, {0.22, 1, 0.1}, 1);
  for (const char* name : {"a", "b"}) {
    Node node;
    node.name = name;
    mesh.rig.nodes.push_back(node);
    mesh.rig.bones.push_back({static_cast<Index>(mesh.rig.bones.size()), Affine::Identity()});
  }
  return mesh;
}

TEST_CASE("spheres stand along long triangles, and each has a triangle of its own") {
  const FittedCharacter fit = fitted(two_bars());
  check_fit(fit, kHalvedSpheresMax);
  CHECK(fit.quality.far_area < kFarAreaGood);
  std::vector<std::size_t> owned(fit.spheres.spheres.size());
  for (const std::uint32_t sphere : fit.spheres.of_skin) ++owned[sphere];
  CHECK(*std::min_element(owned.begin(), owned.end()) > 0);
  for (const std::vector<std::uint32_t>& spheres : fit.spheres.of_region) {
    double low = 1, high = 0;
    for (const std::uint32_t sphere : spheres) {
      low = std::min(low, fit.spheres.spheres[sphere].ball.center.y());
      high = std::max(high, fit.spheres.spheres[sphere].ball.center.y());
    }
    CHECK(low < 0.2);
    CHECK(high > 0.8);
  }
}

TEST_CASE("a sphere follows skin that moves alike: it neither grows nor leaves its skin where other bones tear away") {
  const FittedCharacter fit = fitted(two_bars());
  const Mesh& rest = fit.segmentation.regions.body.mesh;
  for (std::size_t i = 0; i < fit.spheres.spheres.size(); ++i) {
    const BoundSphere& sphere = fit.binding.spheres[i];
    CAPTURE(i);
    CHECK((sphere.rest.center - fit.spheres.spheres[i].ball.center).norm() < 1e-6);
    for (const BoundPivot& pivot : sphere.pivots) {
      CHECK(fit.segmentation.regions.of_skin[pivot.triangle] == fit.spheres.spheres[i].region);
    }
  }
  // The second bar turns about its end and goes away; the rule of moments refits the spheres.
  Affine away = Affine::Identity();
  away.translate(Vec3(3, 0, 0)).rotate(Eigen::AngleAxisd(2, Vec3(0.6, 0, 0.8)));
  const std::vector<Affine> bones{Affine::Identity(), away};
  Mesh posed = rest;
  for (Vec3& p : posed.positions) p = bones[p.x() > 0.11 ? 1 : 0] * p;
  for (const BoundSphere& sphere : fit.binding.spheres) {
    Vec3 center = Vec3::Zero();
    for (const BoundPivot& pivot : sphere.pivots) center += pivot.weight * triangle_centroid(posed, pivot.triangle);
    double squares = 0;
    for (const BoundPivot& pivot : sphere.pivots) {
      squares += (triangle_centroid(posed, pivot.triangle) - center).squaredNorm();
    }
    const double spread = std::sqrt(squares / static_cast<double>(sphere.pivots.size()));
    CHECK(spread == doctest::Approx(sphere.spread));
    CHECK((center - bones[sphere.rest.center.x() > 0.11 ? 1 : 0] * sphere.rest.center).norm() < 1e-6);
  }
}

TEST_CASE("a facing direction in the settings is forward where parts follow the bones, too" *
          doctest::test_suite("many bakes")) {
  BakeSettings settings;
  settings.segment.facing = Vec3(0, 0.5, -2);
  const BodyFrame frame = fitted(mesh_of(hand()), settings).segmentation.regions.frame;
  CHECK((frame.forward - Vec3(0, 0, -1)).norm() < 1e-9);
  CHECK((frame.left - frame.up.cross(frame.forward)).norm() < 1e-9);
}

TEST_CASE("a sphere of a half tube is the one that a search over a grid finds") {
  constexpr Index kRings = 41, kAround = 48;
  constexpr double kLength = 0.8;
  Mesh tube;
  std::vector<Index> half;
  for (Index ring = 0; ring < kRings; ++ring) {
    for (Index k = 0; k < kAround; ++k) {
      const double angle = 2 * std::numbers::pi * k / kAround;
      tube.positions.emplace_back(std::cos(angle), kLength * ring / (kRings - 1), -std::sin(angle));
      if (ring + 1 == kRings) continue;
      const Index a = ring * kAround + k, b = ring * kAround + (k + 1) % kAround, up = kAround;
      for (const Triangle& t : {Triangle{a, b, a + up}, Triangle{b, b + up, a + up}}) {
        if (k < kAround / 2) half.push_back(static_cast<Index>(tube.triangles.size()));
        tube.triangles.push_back(t);
      }
    }
  }
  const PieceFitter fitter(tube, 0.1);
  const Samples skin = fitter.samples_of(half);
  const Piece piece = fitter.fit(skin);
  const auto skin_error = [&](const Ball& ball) {
    double sum = 0;
    for (const std::uint32_t sample : skin) sum += fitter.error_of(sample, ball);
    return sum;
  };
  Ball best{Vec3::Zero(), 0};
  double least = std::numeric_limits<double>::max();
  for (int z = -8; z <= 4; ++z) {
    for (int r = 10; r <= 30; ++r) {
      const Ball ball{{0, 0.5 * kLength, 0.05 * z}, 0.05 * r};
      const double error = skin_error(ball);
      if (error >= least) continue;
      least = error;
      best = ball;
    }
  }
  CHECK(piece.ball.radius == doctest::Approx(best.radius).epsilon(0.08));
  CHECK((piece.ball.center - best.center).norm() < 0.1);
  CHECK(skin_error(piece.ball) < 1.1 * least);
}
