// SPDX-License-Identifier: GPL-3.0-or-later
// Robots of volumes made by hand. tests/export has what MuJoCo, urdfdom and planners say of real characters.
#include <doctest/doctest.h>

#include <algorithm>
#include <numbers>
#include <regex>

#include "baker/export/robot.h"

using namespace spherechain::baker;

namespace {

double distance_by_balls(const ConeVolume& cone, const Vec3& point) {
  double out = INFINITY;
  for (int i = 0; i <= 500; ++i) {
    const double t = i / 500.0;
    const double radius = cone.radius_a + t * (cone.radius_b - cone.radius_a);
    out = std::min(out, (point - cone.a - t * (cone.b - cone.a)).norm() - radius);
  }
  return out;
}

std::vector<Vec3> directions() {
  std::vector<Vec3> out;
  for (int i = 0; i < 18; ++i) {
    for (int j = 1; j < 12; ++j) {
      const double around = i * std::numbers::pi / 9, down = j * std::numbers::pi / 12;
      out.emplace_back(std::sin(down) * std::cos(around), std::sin(down) * std::sin(around), std::cos(down));
    }
  }
  return out;
}

double distance_to(const std::vector<BallVolume>& balls, const Vec3& point) {
  double out = INFINITY;
  for (const BallVolume& ball : balls) out = std::min(out, (point - ball.center).norm() - ball.radius);
  return out;
}

ColliderBody body(const char* name, int parent, const Vec3& at, std::vector<Volume> volumes) {
  ColliderBody out;
  out.name = name;
  out.parent = parent;
  out.rest.translation() = at;
  out.volumes = std::move(volumes);
  return out;
}

// A trunk of a box and an ellipsoid, a limb of a capsule, a cone and a tiny ball, a part without volumes, and one
// apart.
Colliders figure() {
  Colliders out;
  out.source_file = "odd -- figure.glb";
  out.height = 2;
  out.left = Vec3::UnitX();
  out.up = Vec3::UnitY();
  out.forward = Vec3::UnitZ();
  const Eigen::Quaterniond tilt(Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()));
  out.bodies = {
      body("no", -1, {0, 1, 0},
           {BoxVolume{{0, 0, 0}, tilt, {0.1, 0.2, 0.3}}, EllipsoidVolume{{0, 0.4, 0}, tilt, {0.1, 0.3, 0.2}}}),
      body("left arm", 0, {0.5, 1, 0},
           {ConeVolume{{0, 0, 0}, {0.5, 0, 0}, 0.1, 0.1}, ConeVolume{{0.5, 0, 0}, {1, 0, 0}, 0.1, 0.03}}),
      body("left-arm", 1, {1.5, 1, 0}, {BallVolume{{0, 0, 0}, 0.00001}}), body("collar", 0, {0, 1.5, 0}, {}),
      body("base link", -1, {0, 3, 0}, {BallVolume{{0, 0, 0}, 0.1}})};
  out.ignored = {{0, 1, IgnoredReason::kAdjacent}, {0, 2, IgnoredReason::kNever}, {1, 2, IgnoredReason::kRest}};
  return out;
}

std::size_t count(const std::string& text, const std::string& word) {
  std::size_t out = 0;
  for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += word.size()) ++out;
  return out;
}

}  // namespace

TEST_CASE("the distance to a cone is that to the balls between its two") {
  for (const ConeVolume& cone :
       {ConeVolume{{0, 0, 0}, {1, 0.5, 0}, 0.6, 0.2}, ConeVolume{{0, 0, 1}, {0, 1, 0}, 0.1, 0.7},
        ConeVolume{{0, 0, 0}, {1, 0, 0}, 0.3, 0.3}}) {
    for (const Vec3& direction : directions()) {
      for (const double far : {0.2, 0.7, 2.0}) {
        const Vec3 point = 0.5 * (cone.a + cone.b) + far * direction;
        CHECK(signed_distance(cone, point) == doctest::Approx(distance_by_balls(cone, point)).epsilon(1e-4));
      }
    }
  }
}

TEST_CASE("balls along a cone have its surface within a fortieth of its radius there") {
  for (const double small : {0.3, 0.29, 0.2, 0.05, 0.02}) {
    const ConeVolume cone{{0.1, 0.2, 0.3}, {1.1, 0.2, 0.3}, 0.3, small};
    const std::vector<BallVolume> balls = balls_of(cone);
    CHECK(balls.size() <= 24);
    const double sine = (0.3 - small) / 1.0, cosine = std::sqrt(1 - sine * sine);
    for (double t = 0; t <= 1; t += 0.01) {
      const double radius = 0.3 + t * (small - 0.3);
      const Vec3 on_surface = cone.a + t * (cone.b - cone.a) + radius * (sine * Vec3::UnitX() + cosine * Vec3::UnitZ());
      CHECK(std::abs(distance_to(balls, on_surface)) <= 0.0255 * radius);
    }
  }
  CHECK(balls_of(ConeVolume{{0, 0, 0}, {0.1, 0, 0}, 0.05, 0.4}).size() == 1);  // one ball holds the other
}

TEST_CASE("balls over an ellipsoid cover it and stand out by an eighth of its smallest radius") {
  const EllipsoidVolume ellipsoid{
      {1, 2, 3}, Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Vec3::UnitZ())), {0.1, 0.25, 0.15}};
  const std::vector<BallVolume> balls = balls_of(ellipsoid);
  CHECK(balls.size() <= 48);
  for (const Vec3& direction : directions()) {
    const Vec3 on_surface = support(ellipsoid, direction);
    CHECK(distance_to(balls, on_surface) <= 0.005);
    CHECK(distance_to(balls, on_surface + 0.0125 * direction) >= 0);
  }
}

TEST_CASE("a ball has the mass and the inertia of water, and two bodies share what both hold") {
  Colliders colliders;
  colliders.bodies = {body("a", -1, {0, 0, 0}, {BallVolume{{0, 0, 0}, 0.1}}),
                      body("b", 0, {5, 0, 0}, {BallVolume{{0, 0, 0}, 0.1}}),
                      body("c", 0, {5, 0, 0}, {BallVolume{{0, 0, 0}, 0.1}}), body("d", 0, {0, 0, 0}, {})};
  const std::vector<SolidMass> masses = masses_of(colliders);
  const double ball = 1000 * 4.0 / 3 * std::numbers::pi * 0.001;
  CHECK(masses[0].kilograms == doctest::Approx(ball).epsilon(0.01));
  CHECK(masses[0].inertia(1, 1) == doctest::Approx(0.4 * ball * 0.01).epsilon(0.01));
  CHECK(masses[1].kilograms == doctest::Approx(ball / 2).epsilon(0.01));
  CHECK(masses[3].kilograms == doctest::Approx(2 * ball / 1000).epsilon(0.01));
  CHECK(masses[3].inertia(0, 0) > 0);
}

TEST_CASE("names of links differ, from that of the base too") {
  const std::vector<std::string> names = link_names(figure());
  CHECK(names == std::vector<std::string>{"no", "left_arm", "left_arm_2", "collar", "base_link_2"});
}

TEST_CASE("MuJoCo gets each solid that it has, and balls in place of a cone") {
  const Export made = export_mjcf(figure());
  const std::string& xml = made.files.at(0).bytes;
  for (const char* type : {"box", "ellipsoid", "capsule"}) CHECK(count(xml, std::string("type=\"") + type + "\"") == 1);
  CHECK(count(xml, "type=\"sphere\"") == 2 + balls_of(std::get<ConeVolume>(figure().bodies[1].volumes[1])).size());
  CHECK(count(xml, "<exclude ") == 3);
  CHECK(count(xml, "<freejoint") == 2);
  CHECK(count(xml, "<inertial") == 5);
  CHECK(made.notes.size() == 2);
  CHECK(count(xml, "--") == 2);  // of its one comment
}

TEST_CASE("URDF keeps boxes, and every link but the base has a mass") {
  const Export made = export_urdf(figure());
  const std::string& urdf = made.files.at(0).bytes;
  CHECK(made.files.at(1).ending == ".srdf");
  CHECK(count(urdf, "<box ") == 1);
  CHECK(count(urdf, "<link ") == 1 + count(urdf, "<inertial>"));
  CHECK(count(urdf, "<joint ") == 2 * 6 + 3 * 3);
  for (const char* reason : {"Adjacent", "Never", "Default"}) CHECK(count(made.files.at(1).bytes, reason) == 1);
}

TEST_CASE("YAML has no number that YAML 1.1 takes for a text, and no bare name") {
  for (const Export& made : {export_xrdf(figure()), export_curobo(figure())}) {
    const std::string& yaml = made.files.at(0).bytes;
    CHECK(made.files.at(1).ending == ".urdf");
    CHECK_FALSE(std::regex_search(yaml, std::regex("[0-9]e[-+]?[0-9]")));
    CHECK(yaml.find("radius: 0.00001}") != std::string::npos);
    CHECK_FALSE(std::regex_search(yaml, std::regex("[^\"]no[\",:]")) == std::regex_search(yaml, std::regex("\"no\"")));
    CHECK(count(yaml, "\"collar\"") == 0);  // a link without spheres
  }
}
