// SPDX-License-Identifier: GPL-3.0-or-later
// Shapes that engines cannot hold are replaced, and reported. tests/export checks that the files are right.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "baker/export/for_engines.h"
#include "baker/export/formats.h"
#include "baker/mesh/error.h"

namespace spherechain::engines_test {
namespace {

using namespace baker;
using Vec = baker::Vec3;

// A body for each of these bones; an empty name: no bone moves it.
Colliders bodies_on(const std::vector<std::string>& bones) {
  Colliders out;
  out.source_file = "person.glb";
  out.height = 1.7;
  out.left = Vec::UnitX();
  out.up = Vec::UnitY();
  out.forward = Vec::UnitZ();
  for (const std::string& bone : bones) {
    ColliderBody body;
    body.name = "part " + std::to_string(out.bodies.size());
    body.bone = bone;
    body.parent = static_cast<int>(out.bodies.size()) - 1;
    body.volumes.emplace_back(BallVolume{{static_cast<double>(out.bodies.size()), 0, 0}, 0.1});
    out.bodies.push_back(body);
  }
  return out;
}

int count(const std::string& text, const std::string& what) {
  int out = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++out;
  return out;
}

}  // namespace

TEST_CASE("exports: bodies of one bone are one body, and ignored where all of their parts are") {
  Colliders colliders = bodies_on({"spine", "spine", "arm", "leg"});
  colliders.ignored = {{0, 2, IgnoredReason::kRest}, {1, 2, IgnoredReason::kRest}, {1, 3, IgnoredReason::kNever}};
  std::vector<std::string> notes;
  join_bodies_of_a_bone(colliders, notes);
  REQUIRE(colliders.bodies.size() == 3);
  CHECK(colliders.bodies[0].volumes.size() == 2);
  CHECK(colliders.bodies[1].parent == 0);  // of the part that joined
  CHECK(colliders.bodies[2].parent == 1);
  REQUIRE(colliders.ignored.size() == 1);  // the leg may touch the spine's first part
  CHECK(colliders.ignored[0].a == 0);
  CHECK(colliders.ignored[0].b == 1);
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].find("part 1") != std::string::npos);
}

TEST_CASE("exports: bodies that no bone moves are left out of formats that attach to bones") {
  Colliders colliders = bodies_on({"spine", "", "arm"});
  colliders.ignored = {{0, 1, IgnoredReason::kAdjacent}, {0, 2, IgnoredReason::kRest}};
  const Export unity = export_unity(colliders);
  const auto json = nlohmann::json::parse(unity.files[0].bytes);
  REQUIRE(json["bodies"].size() == 2);
  CHECK(json["bodies"][1]["parent"] == "part 0");  // the nearest above that stays
  CHECK(json["ignored"].size() == 1);
  REQUIRE(unity.notes.size() == 1);
  CHECK(unity.notes[0].find("part 1") != std::string::npos);
  CHECK(count(export_usd(colliders).files[0].bytes, "PhysicsRigidBodyAPI") == 3);
  CHECK_THROWS_AS(export_godot(bodies_on({"", ""})), Error);
}

TEST_CASE("exports: capsules in place of cones and ellipsoids, and how far their surface is") {
  Colliders colliders = bodies_on({"arm"});
  colliders.bodies[0].volumes = {ConeVolume{{0, 0, 0}, {0.3, 0, 0}, 0.1, 0.06},
                                 EllipsoidVolume{{0, 1, 0}, Eigen::Quaterniond::Identity(), {0.1, 0.3, 0.12}},
                                 // A cone of which one ball holds the other.
                                 ConeVolume{{0, 0, 0}, {0.01, 0, 0}, 0.02, 0.1}};
  std::vector<std::string> notes;
  use_balls(colliders);
  use_capsules_for_cones(colliders, notes);
  use_capsules_for_ellipsoids(colliders, notes);
  const auto& cone = std::get<ConeVolume>(colliders.bodies[0].volumes[0]);
  CHECK(cone.radius_a == doctest::Approx(0.08));
  CHECK(cone.radius_b == cone.radius_a);
  const auto& ellipsoid = std::get<ConeVolume>(colliders.bodies[0].volumes[1]);
  CHECK(std::abs(ellipsoid.b.y() - ellipsoid.a.y()) == doctest::Approx(2 * (0.3 - 0.11)));
  CHECK(ellipsoid.radius_a == doctest::Approx(0.11));
  const auto& ball = std::get<BallVolume>(colliders.bodies[0].volumes[2]);
  CHECK(ball.radius == 0.1);
  CHECK(ball.center.x() == 0.01);
  REQUIRE(notes.size() == 2);
  CHECK(notes[0].find("1 cones") == 0);
  CHECK(notes[0].find("20.0 mm") != std::string::npos);  // at its ends
}

TEST_CASE("exports: USD names are identifiers, each once, and its up is the file's") {
  Colliders colliders = bodies_on({"a", "b", "c"});
  colliders.bodies[0].name = "1st toe";
  colliders.bodies[1].name = "1st.toe";
  colliders.up = Vec::UnitZ();
  const std::string text = export_usd(colliders).files[0].bytes;
  CHECK(count(text, "def Xform \"_1st_toe\" (") == 1);
  CHECK(count(text, "def Xform \"_1st_toe_2\" (") == 1);
  CHECK(count(text, "upAxis = \"Z\"") == 1);
}

}  // namespace spherechain::engines_test
