// SPDX-License-Identifier: GPL-3.0-or-later
// Height, metres and the way up are those of the character as it stands in its scene.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <sstream>

#include "baker/calibrate/random_poses.h"
#include "baker/import/notes.h"
#include "baker/import/source_rig.h"
#include "baker/motion/motion.h"
#include "baker/report/report.h"
#include "baker/segment/by_bones.h"
#include "gltf_reference.h"
#include "role_cases.h"

using namespace spherechain::baker;

namespace {

// The column as it was bound, with its parent as a third joint, which moves nothing and was bound by `inverse_bind`.
Glb with_root(const std::vector<float>& inverse_bind) {
  Glb glb = two_boxes();
  glb.json["nodes"][2].erase("rotation");
  std::vector<float> all{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
                         1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -2, 0, 1};
  all.insert(all.end(), inverse_bind.begin(), inverse_bind.end());
  glb.json["skins"] = {{{"joints", {1, 2, 3}}, {"inverseBindMatrices", glb.accessor(all, "MAT4")}}};
  return glb;
}

Affine scaled(double by) {
  Affine map = Affine::Identity();
  map.linear() *= by;
  return map;
}

// A tetrahedron about each joint.
SourceMesh with_skin(const NamedRig& rig) {
  SourceMesh mesh;
  mesh.rig = rig.rig;
  mesh.rig.weights.clear();
  for (std::size_t v = 0; v < rig.positions.size(); ++v) {
    const auto first = static_cast<Index>(mesh.positions.size());
    for (const Vec3& corner : {Vec3(0, 0, 0), Vec3(0.02, 0, 0), Vec3(0, 0.02, 0), Vec3(0, 0, 0.02)}) {
      mesh.positions.push_back(rig.positions[v] + corner);
      mesh.rig.weights.push_back(rig.rig.weights[v]);
    }
    for (const Triangle& t : {Triangle{0, 2, 1}, Triangle{0, 1, 3}, Triangle{1, 2, 3}, Triangle{0, 3, 2}})
      mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
  }
  return mesh;
}

// The rig below a node that turns it, skin and all, as assimp has what a scene tilts.
SourceMesh tilted(const Eigen::Quaterniond& turn) {
  std::string tree = "Place = !root\n", line;
  for (std::istringstream lines(kMixamo); std::getline(lines, line);) tree += "  " + line + "\n";
  SourceMesh mesh = with_skin(named_rig(tree));
  for (Vec3& p : mesh.positions) p = turn * p;
  for (Bone& bone : mesh.rig.bones) bone.inverse_bind = bone.inverse_bind * Affine(turn.conjugate());
  mesh.rig.nodes[0].local = Affine(turn);
  decompose(mesh.rig.nodes[0]);
  return mesh;
}

}  // namespace

TEST_CASE("the scale of an armature is the character's, whatever it is") {
  for (const double scale : {1.0, 0.1, 0.01, 10.0, 0.0254}) {
    CAPTURE(scale);
    Glb glb = two_boxes();
    glb.json["nodes"][3]["scale"] = {scale, scale, scale};
    const SourceMesh mesh = read(glb);
    CHECK(mesh.metres_per_unit == doctest::Approx(scale));
    CHECK(mesh.positions == read(two_boxes()).positions);
  }
}

TEST_CASE("a root that was bound in other units or axes than the bones that move skin says nothing about them") {
  for (const std::vector<float>& root : {std::vector<float>{10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 10, 0, 0, 0, 0, 1},
                                         {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1}}) {
    Glb glb = with_root(root);
    CHECK(read(glb).metres_per_unit == doctest::Approx(1));
    CHECK(read(glb).up_hint.isApprox(Vec3::UnitY()));
    // Above it all is as it was.
    glb.json["nodes"].push_back({{"children", {3}}, {"scale", {0.1, 0.1, 0.1}}, {"rotation", {-0.5, 0.5, 0.5, 0.5}}});
    glb.json["scenes"][0]["nodes"] = {0, 4};
    CHECK(read(glb).metres_per_unit == doctest::Approx(0.1));
    CHECK(std::abs(read(glb).up_hint.y()) < 1e-6);
  }
}

TEST_CASE("the map that holds for most of the skin is taken, the first of those that are alike") {
  CHECK(typical_map({scaled(2)}, {0}) == 0);
  CHECK(typical_map({scaled(1), scaled(1), scaled(1)}, {1, 5, 2}) == 0);
  CHECK(typical_map({scaled(10), scaled(1), scaled(1)}, {0, 1, 1}) == 1);
  CHECK(typical_map({scaled(10), scaled(10), scaled(10), scaled(1)}, {0, 0, 0, 7}) == 3);
  CHECK(typical_map({scaled(10), scaled(10), scaled(1)}, {0, 0, 0}) == 0);
}

TEST_CASE("a biped that lies in its file stands upright by its rig where its parts follow the bones") {
  SourceMesh mesh = with_skin(named_rig(kMixamo));
  for (const Vec3& up : {Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ()), Vec3(-Vec3::UnitY()), Vec3(Vec3::UnitX()),
                         Vec3(Vec3(0.4, 0.8, -0.4).normalized())}) {
    mesh.up_hint = up;
    Character character = build_character(mesh, "a.glb");
    const Roles roles = find_roles(character.rig, character.source_positions);
    const Regions regions = segment_by_bones(character, roles, std::nullopt, 60);
    CHECK(regions.frame.up.isApprox(Vec3::UnitY()));
    CHECK(regions.frame.left.x() > 0.9);
  }
}

TEST_CASE("a biped is as high as its crown is above its soles, however wide its arms and whatever it holds up") {
  NamedRig rig = named_rig(std::string(kMixamo) + "  Cape = other\n");
  for (std::size_t n = 0, v = 0; n < rig.rig.nodes.size(); ++n) {
    const std::string& name = rig.rig.nodes[n].name;
    if (rig.rig.weights[v].joint[0] >= rig.rig.bones.size() || rig.rig.bones[v].node != n) continue;
    Vec3& at = rig.positions[v];
    if (name.find("LeftHand") != std::string::npos) at += Vec3(2, 0, 0);
    if (name.find("RightHandIndex") != std::string::npos) at = Vec3(-0.7, 3, 0);  // a sword
    if (name == "Cape") at = Vec3(0, -1, -1);
    rig.rig.bones[v].inverse_bind.translation() = -at;
    v = std::min(v + 1, rig.positions.size() - 1);
  }
  SourceMesh mesh = with_skin(rig);
  for (const Vec3& up : {Vec3(Vec3::UnitY()), Vec3(Vec3::UnitZ())}) {  // as it stands, and lying
    mesh.up_hint = up;
    Character character = build_character(mesh, "a.glb");
    const Roles roles = find_roles(character.rig, character.source_positions);
    REQUIRE(roles.kind == BodyKind::kBiped);
    CHECK(segment_by_bones(character, roles, std::nullopt, 60).frame.height == doctest::Approx(1.6));  // 0.02 to 1.62
  }
}

TEST_CASE("a biped is as high as it stands, at whatever angle its scene has it") {
  double height = 0;
  for (const Vec3& turn : {Vec3(0, 0, 0), Vec3(0.5, 0, 0), Vec3(0, 0, -0.3), Vec3(1, -2, 0.4), Vec3(2.5, 0, 1)}) {
    CAPTURE(turn.transpose());
    const double angle = turn.norm();
    Character character = build_character(
        tilted(angle > 0 ? Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) : Eigen::Quaterniond::Identity()),
        "a.dae");
    const Roles roles = find_roles(character.rig, character.source_positions);
    REQUIRE(roles.kind == BodyKind::kBiped);
    const double found = segment_by_bones(character, roles, std::nullopt, 60).frame.height;
    if (angle == 0) height = found;
    CHECK(found == doctest::Approx(height).epsilon(0.02));
  }
}

TEST_CASE("a rig whose joints are bound at one place, all or most of them, has roles and a height by its skin") {
  SourceMesh mesh = with_skin(named_rig(kMixamo));
  take_notes();
  CHECK(build_character(mesh, "a.glb").rig.pivots.empty());
  CHECK(take_notes().empty());
  const std::vector<Bone> bound = mesh.rig.bones;
  for (std::size_t b = 0; b < bound.size(); ++b) {
    if (b % 3 != 0) mesh.rig.bones[b].inverse_bind = Affine::Identity();
  }
  CHECK(build_character(mesh, "a.glb").rig.pivots.size() == mesh.rig.nodes.size());
  const std::vector<std::string> notes = take_notes();
  REQUIRE(notes.size() == 1);
  CHECK(notes[0].find("a.glb: its joints are bound at one place") == 0);
  for (Bone& bone : mesh.rig.bones) bone.inverse_bind = Affine::Identity();
  for (Node& node : mesh.rig.nodes) node.local = Affine::Identity();
  Character character = build_character(mesh, "a.glb");
  CHECK(character.rig.pivots.size() == mesh.rig.nodes.size());
  const Roles roles = find_roles(character.rig, character.source_positions), expected = [&] {
    const SourceMesh plain = with_skin(named_rig(kMixamo));
    return find_roles(plain.rig, plain.positions);
  }();
  for (std::size_t n = 0; n < expected.of_node.size(); ++n) CHECK(roles.of_node[n].role == expected.of_node[n].role);
  CHECK(segment_by_bones(character, roles, std::nullopt, 60).frame.height == doctest::Approx(1.6).epsilon(0.05));

  // Where poses are made for the bake, no joint throws its skin about.
  const RandomPoses poses(character, {});
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    const auto posed = deform(character.source_positions, character.rig.weights, poses.next(random, 2, 0).bones);
    Eigen::AlignedBox3d box;
    for (const Vec3& p : posed) box.extend(p);
    CHECK(box.diagonal().norm() < 4);
  }
}

TEST_CASE("a biped under 0.5 m or over 3 m is reported with the remedy, a dragon or a toy without hands is not") {
  const std::vector<std::string> person{"head", "left hand", "right hand", "left thigh", "right thigh"},
      dragon{"head", "left wing", "right wing", "tail"};
  for (const double metres : {17.6, 3.1, 0.45, 0.0176, 0.00176}) {
    const std::string expected =
        fmt::format("this biped is {:.4g} m tall: --height 1.7 (or --scale {:.3g})", metres, 1.7 / metres);
    CHECK(unit_note(metres, person).find(expected) == 0);
  }
  for (const double metres : {0.55, 1.76, 2.9}) CHECK(unit_note(metres, person).empty());
  CHECK(unit_note(17.6, dragon).empty());
  CHECK(unit_note(0.3, dragon).empty());
  CHECK(unit_note(170, dragon).find("measures 170 m") == 0);
}
