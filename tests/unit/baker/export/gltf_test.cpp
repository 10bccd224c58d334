// SPDX-License-Identifier: GPL-3.0-or-later
// Colliders written into a GLB: what is written is where it should be, and all else is as it was.
#include <doctest/doctest.h>

#include <random>

#include "baker/export/formats.h"
#include "baker/export/glb_json.h"
#include "baker/export/simple_volumes.h"
#include "baker/import/rest_nodes.h"
#include "baker/mesh/error.h"
#include "glb_writer.h"

using namespace spherechain::baker;
using nlohmann::ordered_json;

namespace {

// hips (node 0) with a head (1) and hair (2, 3); a part on each of the two bones.
Colliders two_parts() {
  Colliders out;
  out.source_file = "person.vrm";
  out.height = 1.7;
  ColliderBody hips, head;
  hips.name = "hips";
  hips.bone_index = 0;
  hips.volumes = {ConeVolume{{0.1, 0, 0.02}, {-0.1, 0.05, 0}, 0.12, 0.1}, BallVolume{{0, 0.1, 0.2}, 0.05}};
  head.name = "head";
  head.bone_index = 1;
  head.parent = 0;
  head.volumes = {BallVolume{{0, 0.1, 0.03}, 0.1}};
  out.bodies = {hips, head};
  out.ignored = {{0, 1, IgnoredReason::kAdjacent}};
  return out;
}

std::string source(const std::string& extensions = "") {
  const std::string json = R"({"asset":{"version":"2.0"},"zeta":[1e-10,0.10000000149011612,-0.0,123456789012,1.0],
    "nodes":[{"name":"hips","children":[1]},{"name":"head","translation":[0,0.5,0],"children":[2]},
             {"name":"hair","translation":[0,0.3,0],"children":[3]},{"name":"hair end","translation":[0,0.3,0]}],
    "alpha":{"b":1,"a":2})" +
                           extensions + "}";
  return Glb::container(json, std::string("\1\2\3\0\5\6\7", 7));
}

std::string written(const Export& made) { return made.files.at(0).bytes; }
std::string rest_of(const std::string& glb) {  // after the JSON
  return glb.substr(glb.find("BIN") - 4);
}

// Where a node is in its bone's space.
Affine in_bone(const ordered_json& json, int node, int bone) {
  const RestNodes rest(json);
  return rest.world(bone).inverse() * rest.world(node);
}

}  // namespace

TEST_CASE("an export into a GLB leaves every byte behind the JSON, and every member before its own") {
  const SourceGlb from{source(), {0, 1}};
  const ordered_json before = json_of_glb(from.bytes);
  for (const Export& made :
       {export_vrm(two_parts(), from), export_khr(two_parts(), from), export_omi(two_parts(), from)}) {
    const std::string bytes = written(made);
    CHECK(rest_of(bytes) == rest_of(from.bytes));
    ordered_json after = json_of_glb(bytes);
    CHECK(entry_of(after, "extensionsRequired").is_null());
    for (const auto& used : after["extensionsUsed"]) CHECK(after["extensions"].contains(used));
    after.erase("extensions");
    after.erase("extensionsUsed");
    CHECK(after["asset"]["extras"].erase("spherechain") == 1);  // the tool's mark
    after["asset"].erase("extras");
    const std::size_t count = before["nodes"].size();
    after["nodes"].erase(after["nodes"].begin() + static_cast<std::ptrdiff_t>(count), after["nodes"].end());
    after["nodes"][0]["children"] = before["nodes"][0]["children"];
    after["nodes"][1]["children"] = before["nodes"][1]["children"];
    CHECK(after.dump() == before.dump());
  }
}

TEST_CASE("a second export replaces the first") {
  const SourceGlb from{source(R"(,"extensions":{"VRMC_springBone":{"specVersion":"1.0",
    "colliders":[{"node":1,"shape":{"sphere":{"offset":[0,0,0],"radius":0.1}}}],
    "colliderGroups":[{"name":"mine","colliders":[0]}],
    "springs":[{"joints":[{"node":2},{"node":3}],"colliderGroups":[0]}]}})"),
                       {0, 1}};
  for (Export (*write)(const Colliders&, const SourceGlb&) : {export_vrm, export_khr, export_omi}) {
    Colliders more = two_parts();
    more.bodies[0].volumes.push_back(BallVolume{{0, 0, 0}, 0.2});
    const std::string once = written(write(two_parts(), from));
    CHECK(written(write(two_parts(), {written(write(more, from)), {0, 1}})) == once);
    CHECK(written(export_khr(two_parts(), {written(export_omi(more, from)), {0, 1}})) ==
          written(export_khr(two_parts(), from)));
  }
  ordered_json json = json_of_glb(written(export_khr(two_parts(), from)));
  json["nodes"].push_back({{"name", "of somebody else"}});
  CHECK_THROWS_AS(export_khr(two_parts(), {with_json(from.bytes, json), {0, 1}}), Error);
}

TEST_CASE("springs of VRM 1.0 keep their groups and collide with ours, but not where they start inside one") {
  const SourceGlb from{source(R"(,"extensions":{"VRMC_springBone":{"specVersion":"1.0",
    "colliders":[{"node":1,"shape":{"sphere":{"offset":[0,0,0],"radius":0.1}}}],
    "colliderGroups":[{"name":"mine","colliders":[0]}],
    "springs":[{"joints":[{"node":2},{"node":3}],"colliderGroups":[0]},{"joints":[{"node":2},{"node":3}]}]}})"),
                       {0, 1}};
  const auto bones_of = [&](const Colliders& colliders) {
    return json_of_glb(written(export_vrm(colliders, from)))["extensions"]["VRMC_springBone"];
  };
  const ordered_json bones = bones_of(two_parts());
  CHECK(bones["colliders"].size() == 4);
  CHECK(bones["colliderGroups"][1]["name"] == "spherechain hips");
  CHECK(bones["colliderGroups"][2]["colliders"] == ordered_json{3});
  CHECK(bones["colliders"][3]["node"] == 1);
  CHECK(bones["springs"][0]["colliderGroups"] == ordered_json{0, 1, 2});
  CHECK(bones["springs"][1]["colliderGroups"] == ordered_json{1, 2});
  CHECK(bones["colliders"][1]["shape"]["capsule"]["tail"] == ordered_json{-0.1, 0.05, 0.0});

  Colliders big = two_parts();
  big.bodies[1].volumes = {BallVolume{{0, 0.5, 0}, 0.3}};  // around the hair's end
  CHECK(bones_of(big)["springs"][0]["colliderGroups"] == ordered_json{0, 1});
  big.bodies[0].volumes = {BallVolume{{0, 1, 0}, 0.3}};
  CHECK(!bones_of(big)["springs"][1].contains("colliderGroups"));
}

TEST_CASE("VRM 0.x has spheres whose z is mirrored") {
  const SourceGlb from{source(R"(,"extensions":{"VRM":{"secondaryAnimation":{
    "boneGroups":[{"bones":[2],"colliderGroups":[0]}],
    "colliderGroups":[{"node":1,"colliders":[{"offset":{"x":0,"y":0,"z":0},"radius":0.1}]}]}}})"),
                       {0, 1}};
  const Export made = export_vrm(two_parts(), from);
  const ordered_json animation = json_of_glb(written(made))["extensions"]["VRM"]["secondaryAnimation"];
  CHECK(animation["boneGroups"][0]["colliderGroups"] == ordered_json{0, 1, 2});
  CHECK(animation["colliderGroups"][2]["node"] == 1);
  CHECK(animation["colliderGroups"][2]["colliders"][0]["offset"] == ordered_json{{"x", 0.0}, {"y", 0.1}, {"z", -0.03}});
  CHECK(animation["colliderGroups"][1]["colliders"].size() > 3);
  CHECK(made.notes.size() == 1);
  CHECK(written(export_vrm(two_parts(), {written(made), {0, 1}})) == written(made));
}

TEST_CASE("a shape's node puts it where the volume is, whatever scale its bone has") {
  std::mt19937 bits(5);
  const auto number = [&] { return static_cast<double>(bits() % 2001) / 1000 - 1; };
  for (int kind = 0; kind < 4; ++kind) {
    Colliders colliders = two_parts();
    Affine& to_bone = colliders.bodies[0].to_bone;
    to_bone.translation() = Vec3(number(), number(), number());
    const Eigen::Quaterniond turn(Eigen::Quaterniond(number(), number(), number(), number()).normalized());
    to_bone.linear() = 100 * turn.toRotationMatrix();                                          // even
    if (kind == 1) to_bone.linear() = Vec3(1, 2, 0.5).asDiagonal() * turn.toRotationMatrix();  // stretched
    if (kind == 2) to_bone.linear() << 1, 0.4, 0, 0, 1, 0.2, 0.1, 0, 2;                        // sheared
    if (kind == 3) to_bone.linear() = turn.toRotationMatrix() * Vec3(-1, 1, 1).asDiagonal();   // mirrored
    const ordered_json json = json_of_glb(written(export_khr(colliders, {source(), {0, 1}})));
    const ordered_json& shapes = json["extensions"]["KHR_implicit_shapes"]["shapes"];
    int found = 0;
    for (std::size_t n = 0; n < json["nodes"].size(); ++n) {
      const ordered_json& extension = entry_of(entry_of(json["nodes"][n], "extensions"), "KHR_physics_rigid_bodies");
      if (json["nodes"][n]["name"] == "spherechain hips 1") {
        const ordered_json& capsule = shapes[extension["collider"]["geometry"]["shape"].get<std::size_t>()]["capsule"];
        const Affine at = in_bone(json, static_cast<int>(n), 0);
        const double half = capsule["height"].get<double>() / 2;
        const auto& cone = std::get<ConeVolume>(colliders.bodies[0].volumes[0]);
        CHECK((at * Vec3(0, -half, 0) - to_bone * cone.a).norm() < 1e-9 * to_bone.linear().norm());
        CHECK((at * Vec3(0, half, 0) - to_bone * cone.b).norm() < 1e-9 * to_bone.linear().norm());
        CHECK(capsule["radiusBottom"] == cone.radius_a);
        ++found;
      }
      if (json["nodes"][n]["name"] == "spherechain hips") {  // a body in metres: the bone's scale is undone
        CHECK(extension["motion"]["isKinematic"] == true);
        CHECK((in_bone(json, static_cast<int>(n), 0).matrix() - to_bone.matrix()).norm() <
              1e-9 * to_bone.linear().norm());
        ++found;
      }
    }
    CHECK(found == 2);
  }
}

TEST_CASE("both sides of a pair that is not tested name the other, in the words of either extension") {
  Colliders colliders = two_parts();
  colliders.bodies.push_back(colliders.bodies[1]);
  colliders.bodies.back().name = "hat";
  const SourceGlb from{source(), {0, 1}};
  const ordered_json khr = json_of_glb(written(export_khr(colliders, from))),
                     omi = json_of_glb(written(export_omi(colliders, from)));
  CHECK(khr["extensions"]["KHR_physics_rigid_bodies"] == omi["extensions"]["OMI_physics_body"]);
  CHECK(khr["extensions"]["KHR_implicit_shapes"] == omi["extensions"]["OMI_physics_shape"]);
  const ordered_json& filters = khr["extensions"]["KHR_physics_rigid_bodies"]["collisionFilters"];
  CHECK(filters[0]["notCollideWithSystems"] == ordered_json{"spherechain head"});
  CHECK(filters[1]["notCollideWithSystems"] == ordered_json{"spherechain hips"});
  CHECK(!filters[2].contains("notCollideWithSystems"));
  const ordered_json& last = omi["nodes"].back()["extensions"]["OMI_physics_body"]["collider"];
  CHECK(last == ordered_json{{"shape", 3}, {"collisionFilter", 2}});
  CHECK_THROWS_AS(export_khr(colliders, {from.bytes, {-1, -1}}), Error);
}

TEST_CASE("what stands for a volume keeps its size, and is no farther off than it says") {
  const Eigen::Quaterniond turn(Eigen::Quaterniond(1, 2, 3, 4).normalized());
  const Volume all[] = {ConeVolume{{0, 0, 0}, {0.2, 0.1, 0}, 0.1, 0.05},
                        EllipsoidVolume{{1, 2, 3}, turn, {0.1, 0.3, 0.15}},
                        BoxVolume{{1, 2, 3}, turn, {0.1, 0.3, 0.15}}};
  for (const Volume& volume : all) {
    const SimpleVolumes capsule = as_capsule(volume);
    REQUIRE(capsule.volumes.size() == 1);
    CHECK(volume_of(capsule.volumes[0]) == doctest::Approx(volume_of(volume)).epsilon(1e-6));
    CHECK(capsule.off > 0);
    CHECK(capsule.off < 0.15);
  }
  // Balls lie inside the cone; no point of its surface is farther from all of them than said.
  const SimpleVolumes balls = as_balls(all[0]);
  std::mt19937 bits(9);
  double gap = 0;
  for (int i = 0; i < 20000; ++i) {
    Vec3 point(static_cast<double>(bits() % 1000) / 2000 - 0.15, static_cast<double>(bits() % 1000) / 2000 - 0.2,
               static_cast<double>(bits() % 1000) / 2000 - 0.25);
    double nearest = 1;
    for (const Volume& ball : balls.volumes) nearest = std::min(nearest, signed_distance(ball, point));
    const double deep = signed_distance(all[0], point);
    CHECK((nearest > 0 || deep < 1e-9));
    if (nearest > 0) gap = std::max(gap, -deep);
  }
  CHECK(gap <= balls.off + 1e-9);
  CHECK(gap > 0.5 * balls.off);
  const Volume swallowed = ConeVolume{{0, 0, 0}, {0.1, 0, 0}, 0.2, 0.05};
  CHECK(std::holds_alternative<BallVolume>(without_inner_ball(swallowed)));
}
