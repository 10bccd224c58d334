// SPDX-License-Identifier: GPL-3.0-or-later
// A file's content decides how it is read, whatever its ending; an avatar's humanoid goes before the names of its
// nodes.
#include <doctest/doctest.h>

#include "gltf_reference.h"
#include "human.h"
#include "role_cases.h"
#include "temporary_folder.h"

using namespace spherechain::baker;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

std::string first_humanoid_bone(const json& extensions) {
  Glb glb = two_boxes();
  glb.json["extensions"] = extensions;
  const TemporaryFolder folder;
  for (const Node& node : read_source(folder.write("avatar.vrm", glb.bytes())).rig.nodes) {
    if (!node.humanoid_bone.empty()) return node.name + " is " + node.humanoid_bone;
  }
  return "none";
}

}  // namespace

TEST_CASE("a glTF is read as one under every ending") {
  const TemporaryFolder folder;
  const Glb glb = two_boxes();
  const SourceMesh read = read_source(folder.write("a.glb", glb.bytes()));
  for (const char* name : {"a.vrm", "a.fbx", "a.obj", "a.bin", "a"}) {
    CAPTURE(name);
    const SourceMesh other = read_source(folder.write(name, glb.bytes()));
    CHECK(other.importer == "tinygltf");
    CHECK(other.positions == read.positions);
    CHECK(other.triangles == read.triangles);
  }
  folder.write("a.bin", glb.binary);
  CHECK(read_source(folder.write("a.txt", " \n" + glb.text("a.bin"))).positions == read.positions);
}

TEST_CASE("other formats with a misleading ending are read by their content" * doctest::test_suite("many bakes")) {
  for (const char* file : {"FBX/spider.fbx", "Collada/human.zae", "X/Testwuson.X", "OBJ/spider.obj", "PLY/Wuson.ply",
                           "BLEND/Suzanne_248.blend", "MS3D/jeep1.ms3d", "STL/Spider_ascii.stl"}) {
    CAPTURE(file);
    const SourceMesh read = read_source(fs::path("/usr/share/assimp/models") / file);
    for (const char* ending : {"glb", "fbx", "dae", "ply", "txt"}) {
      CAPTURE(ending);
      const TemporaryFolder folder;
      const fs::path renamed = folder.path / (std::string("a.") + ending);
      fs::copy(fs::path("/usr/share/assimp/models") / file, renamed);
      const SourceMesh other = read_source(renamed);
      CHECK(other.triangles == read.triangles);
      CHECK(other.rig.bones.size() == read.rig.bones.size());
    }
  }
}

TEST_CASE("the humanoid of a VRM avatar is read in both versions, and what is wrong in it is left out") {
  const auto vrm0 = [](const json& bones) { return json{{"VRM", {{"humanoid", {{"humanBones", bones}}}}}}; };
  const auto vrm1 = [](const json& bones) { return json{{"VRMC_vrm", {{"humanoid", {{"humanBones", bones}}}}}}; };
  const std::string name = two_boxes().json["nodes"][1].value("name", "");
  CHECK(first_humanoid_bone(vrm0({{{"bone", "hips"}, {"node", 1}}})) == name + " is hips");
  CHECK(first_humanoid_bone(vrm1({{"hips", {{"node", 1}}}})) == name + " is hips");
  for (const json& bones : {json(), json(3), json("hips"), json{{"hips", 1}}, json{{"hips", {{"node", 99}}}},
                            json{{"hips", {{"node", -1}}}}, json{{"hips", {{"node", "1"}}}}}) {
    CAPTURE(bones.dump());
    CHECK(first_humanoid_bone(vrm1(bones)) == "none");
    CHECK(first_humanoid_bone(vrm0(bones)) == "none");
  }
  CHECK(first_humanoid_bone(vrm0({{{"bone", 7}, {"node", 1}}})) == "none");
  CHECK(first_humanoid_bone({{"VRM", 5}}) == "none");
}

TEST_CASE("roles come from an avatar's humanoid, and its nodes' names say nothing") {
  NamedRig rig = named_rig(kMixamo);
  for (std::size_t n = 0; n < rig.expected.size(); ++n) {
    const auto bone = [&](const std::string& role) -> std::string {
      for (const auto& [ours, theirs] : {std::pair("pelvis", "hips"),
                                         {"chest", "upperChest"},
                                         {"head", "head"},
                                         {"left_clavicle", "leftShoulder"},
                                         {"left_shoulder", "leftUpperArm"},
                                         {"left_elbow", "leftLowerArm"},
                                         {"left_wrist", "leftHand"},
                                         {"left_hip", "leftUpperLeg"},
                                         {"left_knee", "leftLowerLeg"},
                                         {"left_ankle", "leftFoot"},
                                         {"right_clavicle", "rightShoulder"},
                                         {"right_shoulder", "rightUpperArm"},
                                         {"right_elbow", "rightLowerArm"},
                                         {"right_wrist", "rightHand"},
                                         {"right_hip", "rightUpperLeg"},
                                         {"right_knee", "rightLowerLeg"},
                                         {"right_ankle", "rightFoot"}}) {
        if (role == ours) return theirs;
      }
      return {};
    };
    // The names are of the other side, or of nothing.
    rig.rig.nodes[n].humanoid_bone = bone(rig.expected[n]);
    std::string& name = rig.rig.nodes[n].name;
    if (const std::size_t left = name.find("Left"); left != name.npos) name.replace(left, 4, "Right");
  }
  const Roles roles = roles_of(rig);
  for (std::size_t n = 0; n < rig.expected.size(); ++n) {
    if (rig.rig.nodes[n].humanoid_bone.empty()) continue;
    CAPTURE(rig.rig.nodes[n].humanoid_bone);
    CHECK(roles.of_node[n].role == rig.expected[n]);
    CHECK(roles.of_node[n].reason.find("humanoid") != std::string::npos);
  }
}
