// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "baker/export/for_engines.h"
#include "baker/export/formats.h"
#include "baker/export/names.h"

// A stage as text: an Xform a body part, kinematic, with its volumes below it. It stands in the axes of the source
// file, in metres, so that it lies on the character where both are loaded.
namespace spherechain::baker {
namespace {

std::string usd_number(double value) { return fmt::format("{}", value == 0 ? 0.0 : value); }

std::string usd_tuple(const Vec3& v) {
  return fmt::format("({}, {}, {})", usd_number(v.x()), usd_number(v.y()), usd_number(v.z()));
}

// Real part first.
std::string usd_orient(const Eigen::Quaterniond& q) {
  return fmt::format("({}, {}, {}, {})", usd_number(q.w()), usd_number(q.x()), usd_number(q.y()), usd_number(q.z()));
}

std::string usd_string(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '\n' || c == '\r' ? ' ' : c;
  }
  return out + "\"";
}

// A prim of one volume: its kind, what describes it, and where it is.
struct UsdShape {
  std::string type, attributes;
  Vec3 center, extent;  // half, in its own axes
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Vec3 scale = Vec3::Ones();
};

UsdShape usd_shape(const BallVolume& ball) {
  UsdShape out;
  out.type = "Sphere";
  out.attributes = fmt::format("            double radius = {}\n", usd_number(ball.radius));
  out.center = ball.center;
  out.extent = Vec3::Constant(ball.radius);
  return out;
}

// Capsule_1 has two radii. No fallbackPrimTypes says that it may be taken for a Capsule: some readers refuse a stage
// with it.
UsdShape usd_shape(const ConeVolume& cone) {
  UsdShape out;
  const double length = (cone.b - cone.a).norm(), widest = std::max(cone.radius_a, cone.radius_b);
  const bool is_tapered = cone.radius_a != cone.radius_b;
  out.type = is_tapered ? "Capsule_1" : "Capsule";
  out.attributes =
      fmt::format("            uniform token axis = \"Y\"\n            double height = {}\n", usd_number(length));
  out.attributes += is_tapered
                        ? fmt::format("            double radiusBottom = {}\n            double radiusTop = {}\n",
                                      usd_number(cone.radius_a), usd_number(cone.radius_b))
                        : fmt::format("            double radius = {}\n", usd_number(cone.radius_a));
  out.center = (cone.a + cone.b) / 2;
  out.rotation = turn_to(1, cone.b - cone.a);
  out.extent = Vec3(widest, length / 2 + widest, widest);
  return out;
}

UsdShape usd_shape(const EllipsoidVolume& ellipsoid) {
  UsdShape out = usd_shape(BallVolume{ellipsoid.center, 1});
  out.rotation = ellipsoid.rotation;
  out.scale = ellipsoid.radii;
  return out;
}

UsdShape usd_shape(const BoxVolume& box) {
  UsdShape out;
  out.type = "Cube";
  out.attributes = "            double size = 2\n";
  out.center = box.center;
  out.rotation = box.rotation;
  out.scale = box.half;
  out.extent = Vec3::Ones();
  return out;
}

std::string usd_prim(const UsdShape& shape, int number) {
  std::string ops = R"("xformOp:translate", "xformOp:orient")";
  std::string scale;
  if (shape.scale != Vec3::Ones()) {
    ops += R"(, "xformOp:scale")";
    scale = fmt::format("            double3 xformOp:scale = {}\n", usd_tuple(shape.scale));
  }
  return fmt::format(R"(
        def {} "volume_{}" (
            prepend apiSchemas = ["PhysicsCollisionAPI"]
        )
        {{
{}            float3[] extent = [{}, {}]
            double3 xformOp:translate = {}
            quatd xformOp:orient = {}
{}            uniform token[] xformOpOrder = [{}]
        }}
)",
                     shape.type, number, shape.attributes, usd_tuple(-shape.extent), usd_tuple(shape.extent),
                     usd_tuple(shape.center), usd_orient(shape.rotation), scale, ops);
}

bool is_usd_character(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0; }

}  // namespace

Export export_usd(const Colliders& given) {
  Colliders colliders = given;
  use_balls(colliders);
  std::vector<std::string> names = unique_names(colliders, is_usd_character);
  for (std::string& name : names) {
    if (std::isdigit(static_cast<unsigned char>(name[0])) != 0) name = "_" + name;
  }
  std::vector<std::string> filtered(names.size());
  for (const IgnoredBodies& pair : colliders.ignored) {
    std::string& list = filtered[static_cast<std::size_t>(pair.a)];
    list += fmt::format("{}</colliders/{}>", list.empty() ? "" : ", ", names[static_cast<std::size_t>(pair.b)]);
  }
  std::string text = fmt::format(R"(#usda 1.0
(
    defaultPrim = "colliders"
    doc = {}
    metersPerUnit = 1
    upAxis = "{}"
)

def Xform "colliders"
{{
)",
                                 usd_string("spherechain: colliders of " + colliders.source_file),
                                 std::abs(colliders.up.z()) > std::abs(colliders.up.y()) ? "Z" : "Y");
  int tapered = 0, scaled = 0;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const ColliderBody& body = colliders.bodies[i];
    const bool has_filter = !filtered[i].empty();
    text += fmt::format(R"(    def Xform "{}" (
        prepend apiSchemas = ["PhysicsRigidBodyAPI"{}]
    )
    {{
        bool physics:kinematicEnabled = 1
{}        custom string spherechain:part = {}
        custom string spherechain:bone = {}
        double3 xformOp:translate = {}
        quatd xformOp:orient = {}
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]
)",
                        names[i], has_filter ? R"(, "PhysicsFilteredPairsAPI")" : "",
                        has_filter ? fmt::format("        rel physics:filteredPairs = [{}]\n", filtered[i]) : "",
                        usd_string(body.name), usd_string(body.bone), usd_tuple(body.rest.translation()),
                        usd_orient(Eigen::Quaterniond(body.rest.linear())));
    int number = 0;
    for (const Volume& volume : body.volumes) {
      const UsdShape shape = std::visit([](const auto& one) { return usd_shape(one); }, volume);
      tapered += shape.type == "Capsule_1" ? 1 : 0;
      scaled += std::holds_alternative<EllipsoidVolume>(volume) ? 1 : 0;
      text += usd_prim(shape, ++number);
    }
    text += "    }\n";
  }
  text += "}\n";
  Export out{{{"", text}}, {"UsdSkel joints are no prims: move each Xform with the joint that spherechain:bone names"}};
  if (tapered > 0) {
    out.notes.push_back(fmt::format(
        "{} cones are Capsule_1, which older programs pass over (--volumes capsules is for them)", tapered));
  }
  if (scaled > 0) {
    out.notes.push_back(fmt::format(
        "{} ellipsoids are spheres with a non-uniform scale; some physics importers take them for spheres", scaled));
  }
  return out;
}

}  // namespace spherechain::baker
