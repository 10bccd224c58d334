// SPDX-License-Identifier: GPL-3.0-or-later
// The names that people have for each part of a body, from the rig's roles or the automatic rig.
#include "baker/bind/body_parts.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>

#include "baked_human.h"
#include "baker/bind/part_names.h"
#include "baker/edits/held_props.h"
#include "role_cases.h"

using namespace spherechain::baker;

namespace {

Names part_names(const BodyParts& parts) {
  Names names;
  for (const BodyPart& part : parts.parts) names.push_back(part.name);
  return names;
}

const BodyPart& part_called(const BodyParts& parts, std::string_view name) {
  const auto found = std::find_if(parts.parts.begin(), parts.parts.end(), [&](auto& p) { return p.name == name; });
  REQUIRE_MESSAGE(found != parts.parts.end(), name);
  return *found;
}

// The mean of the triangles' centroids, each counting the same.
Vec3 middle_of(const Character& character, const BodyParts& parts, const std::string& name) {
  const auto part = static_cast<std::size_t>(&part_called(parts, name) - parts.parts.data());
  const Mesh source{character.source_positions, character.source_triangles};
  Vec3 sum = Vec3::Zero();
  double count = 0;
  for (std::size_t t = 0; t < parts.of_triangle.size(); ++t) {
    if (parts.of_triangle[t] != part) continue;
    sum += triangle_centroid(source, t);
    ++count;
  }
  REQUIRE(count > 0);
  return sum / count;
}

// Every triangle has a part, every part a triangle and a name of its own.
void check_whole(const Character& character, const BodyParts& parts) {
  REQUIRE(parts.of_triangle.size() == character.source_triangles.size());
  const std::set<int> used(parts.of_triangle.begin(), parts.of_triangle.end());
  CHECK(used.size() == parts.parts.size());
  CHECK(*used.rbegin() + 1 == static_cast<int>(parts.parts.size()));
  const Names names = part_names(parts);
  CHECK(std::set<std::string>(names.begin(), names.end()).size() == names.size());
  CHECK(names.size() <= 255);
}

// A character whose n-th triangle hangs on the rig's n-th bone alone.
Character one_triangle_a_bone(const NamedRig& rig) {
  Character character;
  character.rig = rig.rig;
  for (std::size_t i = 0; i < rig.rig.bones.size(); ++i) {
    const auto v = static_cast<Index>(i);
    VertexWeights weights;
    weights.joint[0] = v;
    weights.weight[0] = 1;
    character.source_positions.push_back(rig.positions.empty() ? Vec3::Zero() : Vec3(rig.positions[0]));
    character.source_triangles.push_back({v, v, v});
    character.rig.weights.resize(i);
    character.rig.weights.push_back(weights);
  }
  return character;
}

// The part of each node that moves skin, by the node's name.
std::map<std::string, std::string> part_names_by_node(const NamedRig& rig) {
  const Character character = one_triangle_a_bone(rig);
  const BodyParts parts = find_body_parts(character, roles_of(rig), {}, {}, {});
  check_whole(character, parts);
  std::map<std::string, std::string> out;
  for (std::size_t b = 0; b < rig.rig.bones.size(); ++b) {
    out[rig.rig.nodes[rig.rig.bones[b].node].name] = parts.parts[parts.of_triangle[b]].name;
  }
  return out;
}

struct Shown {
  Character character;
  BodyParts parts;
};

Shown character_of_test_data(const char* file) {
  Shown out{import_character(std::filesystem::path(std::getenv("SPHERECHAIN_TEST_DATA")) / file), {}};
  const Roles roles = find_roles(out.character.rig, out.character.source_positions);
  out.parts = find_body_parts(out.character, roles, {}, {}, {});
  check_whole(out.character, out.parts);
  return out;
}

std::string bone_name(const Shown& shown, const std::string& part) {
  const int bone = part_called(shown.parts, part).bone;
  REQUIRE(bone >= 0);
  return shown.character.rig.nodes[shown.character.rig.bones[static_cast<std::size_t>(bone)].node].name;
}

const Names kHumanParts{"hips",        "abdomen",        "chest",           "neck",
                        "head",        "left shoulder",  "left upper arm",  "left forearm",
                        "left hand",   "right shoulder", "right upper arm", "right forearm",
                        "right hand",  "left thigh",     "left shin",       "left foot",
                        "right thigh", "right shin",     "right foot"};

}  // namespace

TEST_CASE("a body without a rig has the parts of the automatic rig, each where people expect it") {
  const Bake& bake = baked_human();
  const BodyParts& parts = bake.body_parts;
  check_whole(bake.character, parts);
  CHECK(part_names(parts) == kHumanParts);
  const auto at = [&](const char* name) { return middle_of(bake.character, parts, name); };
  const BodyFrame& frame = bake.regions.frame;
  const auto height = [&](const char* name) { return (at(name) - frame.origin).dot(frame.up); };
  CHECK(height("head") > height("neck"));
  CHECK(height("neck") > height("chest"));
  CHECK(height("chest") > height("abdomen"));
  CHECK(height("abdomen") > height("hips"));
  CHECK(height("hips") > height("left thigh"));
  CHECK(height("left thigh") > height("left shin"));
  CHECK(height("left shin") > height("left foot"));
  for (const char* name : {"upper arm", "forearm", "hand", "thigh", "shin", "foot"}) {
    const std::string left = std::string("left ") + name, right = std::string("right ") + name;
    CHECK((at(left.c_str()) - frame.origin).dot(frame.left) > 0);
    CHECK((at(right.c_str()) - frame.origin).dot(frame.left) < 0);
    CHECK(part_called(parts, left).side == Side::kLeft);
    CHECK(part_called(parts, right).side == Side::kRight);
  }
  CHECK(part_called(parts, "head").side == Side::kNone);
  for (const BodyPart& part : parts.parts)
    CHECK(name_part(bake.bones.bones[static_cast<std::size_t>(part.bone)].name).name == part.name);
  CHECK(bake.bones.bones[static_cast<std::size_t>(part_called(parts, "left hand").bone)].name == "left_wrist");
}

TEST_CASE("the parts of a body stay where only later settings differ" * doctest::test_suite("long runs")) {
  const Bake again = rebake(baked_human(), baked_human().settings);
  CHECK(part_names(again.body_parts) == kHumanParts);
  CHECK(again.body_parts.of_triangle == baked_human().body_parts.of_triangle);
}

TEST_CASE("a hand has its fingers, a foot its toes, a limb its twist bones") {
  const auto parts = part_names_by_node(named_rig(kMixamo));
  CHECK(parts.at("mixamorig:Hips") == "hips");
  CHECK(parts.at("mixamorig:Spine1") == "abdomen");
  CHECK(parts.at("mixamorig:Spine2") == "chest");
  CHECK(parts.at("mixamorig:LeftShoulder") == "left shoulder");
  CHECK(parts.at("mixamorig:LeftArm") == "left upper arm");
  CHECK(parts.at("mixamorig:LeftHandIndex3") == "left hand");
  CHECK(parts.at("mixamorig:RightUpLeg") == "right thigh");
  CHECK(parts.at("mixamorig:RightLeg") == "right shin");
  CHECK(parts.at("mixamorig:RightToeBase") == "right foot");
}

TEST_CASE("twist joints of the topmost spine joint are the chest's") {
  const auto parts = part_names_by_node(named_rig(R"(
Hips = pelvis
  Hips_twist1 = other
  Spine = spine
    Spine_twist1 = other
    Spine1 = chest
      Spine1_twist1 = other
      Neck = neck
        Head = head
      LeftArm = left_shoulder
        LeftForeArm = left_elbow
      RightArm = right_shoulder
        RightForeArm = right_elbow
  LeftUpLeg = left_hip
    LeftLeg = left_knee
  RightUpLeg = right_hip
    RightLeg = right_knee)"));
  CHECK(parts.at("Hips_twist1") == "hips");
  CHECK(parts.at("Spine_twist1") == "abdomen");
  CHECK(parts.at("Spine1_twist1") == "chest");
}

TEST_CASE("tail, ears, hair, wings, bags, garments and weapons are parts of their own") {
  const auto parts = part_names_by_node(named_rig(R"(
Root = !root
  J_Bip_C_Hips = pelvis
    J_Sec_L_SkirtBack0_01 = other
      J_Sec_L_SkirtBack1_01 = other
    J_Sec_R_SkirtBack0_01 = other
    tail_02 = tail_1
      TailTip = tail_2
    J_Bip_C_Spine = spine
      J_Bip_C_Chest = spine
        J_Bip_C_UpperChest = chest
          J_Bip_C_Neck = neck
            J_Bip_C_Head = head
              J_Adj_L_FaceEye = eye
              J_Sec_Hair1_01 = hair
                J_Sec_Hair2_01 = hair
                  Bone.014 = head_part
              SideTail_L = head_part
              LeftEar = head_part
                Ear2 = head_part
              rightear = head_part
              antenna = head_part
          J_Sec_L_Bust1 = other
          back_pack.001 = other
            strap = other
          Scabbard_Sword = attachment
          Feather_Wing_1.L = other
            Feather_Wing_2 = other
          wing_top = other
          J_Bip_L_Shoulder = left_clavicle
            J_Bip_L_UpperArm = left_shoulder
              J_Sec_L_TopsUpperArmInside_01 = other
              J_Bip_L_LowerArm = left_elbow
                J_Bip_L_Hand = left_wrist
                  J_Bip_L_Middle1 = left_finger
                  handslot_L = attachment
                    Club = other
                  Weapon = attachment
                    Chain = other
          J_Bip_R_Shoulder = right_clavicle
            J_Bip_R_UpperArm = right_shoulder
              J_Bip_R_LowerArm = right_elbow
                J_Bip_R_Hand = right_wrist
                  J_Bip_R_Middle1 = right_finger
    J_Bip_L_UpperLeg = left_hip
      J_Bip_L_LowerLeg = left_knee
        J_Bip_L_Foot = left_ankle
          J_Bip_L_ToeBase = left_toe
    J_Bip_R_UpperLeg = right_hip
      J_Bip_R_LowerLeg = right_knee
        J_Bip_R_Foot = right_ankle
          J_Bip_R_ToeBase = right_toe
)"));
  CHECK(parts.at("J_Sec_L_SkirtBack1_01") == "skirt");
  CHECK(parts.at("J_Sec_R_SkirtBack0_01") == "skirt");
  CHECK(parts.at("tail_02") == "tail");
  CHECK(parts.at("TailTip") == "tail");
  for (const char* hair : {"J_Sec_Hair2_01", "Bone.014", "SideTail_L"}) CHECK(parts.at(hair) == "hair");
  CHECK(parts.at("LeftEar") == "left ear");
  CHECK(parts.at("Ear2") == "left ear");
  CHECK(parts.at("rightear") == "right ear");
  CHECK(parts.at("antenna") == "head");
  CHECK(parts.at("back_pack.001") == "backpack");
  CHECK(parts.at("strap") == "backpack");
  CHECK(parts.at("Scabbard_Sword") == "sword");
  CHECK(parts.at("Feather_Wing_2") == "left wing");
  CHECK(parts.at("wing_top") == "wings");
  CHECK(parts.at("Weapon") == "left weapon");
  CHECK(parts.at("Chain") == "left weapon");
  CHECK(parts.at("Club") == "Club");
  CHECK(parts.at("J_Adj_L_FaceEye") == "head");
  CHECK(parts.at("J_Sec_L_Bust1") == "chest");
  CHECK(parts.at("J_Bip_C_Chest") == "chest");
  CHECK(parts.at("J_Sec_L_TopsUpperArmInside_01") == "left upper arm");
  CHECK(parts.at("handslot_L") == "handslot_L");
}

// A rig of two arms and the triangle of each bone.
Character armed(std::vector<Node>& extra) {
  NamedRig rig = named_rig(kMixamo);
  std::map<std::string, int> node_of;
  for (std::size_t n = 0; n < rig.rig.nodes.size(); ++n) node_of[rig.rig.nodes[n].name] = static_cast<int>(n);
  for (Node& node : extra) {
    node.parent = node_of.at(node.humanoid_bone);
    node.humanoid_bone.clear();
    node.is_attachment = true;
    rig.rig.bones.push_back({static_cast<Index>(rig.rig.nodes.size()), Affine::Identity()});
    rig.rig.nodes.push_back(node);
  }
  return one_triangle_a_bone(rig);
}

TEST_CASE("rigid meshes on joints are parts, and what a hand holds never meets the hand or what else it holds") {
  std::vector<Node> meshes{{"1H_Axe", "mixamorig:RightHand"},
                           {"Mug", "mixamorig:RightHand"},
                           {"Shield", "mixamorig:LeftForeArm"},
                           {"Pete_Hat", "mixamorig:Head"},
                           {"Pete_Hair", "mixamorig:Head"}};
  const Character character = armed(meshes);
  const Roles roles = find_roles(character.rig, std::vector<Vec3>(character.source_positions));
  const BodyParts parts = find_body_parts(character, roles, {}, {}, {});
  check_whole(character, parts);
  const auto held_by = [&](const char* name) {
    return parts.parts[static_cast<std::size_t>(part_called(parts, name).parent)].name;
  };
  CHECK(held_by("1H_Axe") == "right hand");
  CHECK(held_by("Mug") == "right hand");
  CHECK(held_by("Shield") == "left forearm");
  CHECK(held_by("hat") == "head");
  CHECK(held_by("hair") == "head");
  PartPairs held = held_props(parts);
  std::sort(held.begin(), held.end());
  CHECK(held == PartPairs{{"1H_Axe", "Mug"},
                          {"1H_Axe", "right forearm"},
                          {"1H_Axe", "right hand"},
                          {"Mug", "right forearm"},
                          {"Mug", "right hand"},
                          {"Shield", "left forearm"},
                          {"Shield", "left hand"}});
}

TEST_CASE(
    "a mesh of one part's is named by its node, itself or its material; clothes around several parts stay theirs") {
  Character character = one_triangle_a_bone(named_rig(kMixamo));
  const Roles roles = roles_of(named_rig(kMixamo));
  const std::size_t before = find_body_parts(character, roles, {}, {}, {}).parts.size();
  const auto triangle_of = [&](const char* name) {
    for (Index b = 0; b < character.rig.bones.size(); ++b) {
      if (character.rig.nodes[character.rig.bones[b].node].name == name) return character.source_triangles[b];
    }
    FAIL(name);
    return Triangle{};
  };
  character.buffers.emplace_back();
  character.buffers.back().triangle_count = static_cast<Index>(character.source_triangles.size());
  const auto add = [&](const char* mesh, const std::vector<const char*>& joints) {
    character.buffers.emplace_back();
    character.buffers.back().name = mesh;
    character.buffers.back().triangle_count = static_cast<Index>(joints.size());
    for (const char* joint : joints) character.source_triangles.push_back(triangle_of(joint));
  };
  add("Object_7 Backpack_Mat", {"mixamorig:Spine2", "mixamorig:Spine2"});
  add("LeftEar", {"mixamorig:Head"});
  add("Hair Skirt", {"mixamorig:Head", "mixamorig:Spine2"});
  add("Chest_Armor", {"mixamorig:Spine2"});
  const BodyParts parts = find_body_parts(character, roles, {}, {}, {});
  check_whole(character, parts);
  CHECK(parts.parts.size() == before + 2);
  const BodyPart& backpack = part_called(parts, "backpack");
  CHECK(parts.parts[static_cast<std::size_t>(backpack.parent)].name == "chest");
  CHECK(backpack.bone == part_called(parts, "chest").bone);
  CHECK(part_called(parts, "left ear").side == Side::kLeft);
  CHECK(parts.parts[static_cast<std::size_t>(part_called(parts, "head").parent)].name == "neck");
}

TEST_CASE("animals have forelegs and hind legs, insects numbered legs") {
  const auto fox = part_names_by_node(named_rig(kFox, Body::kFox));
  std::set<std::string> names;
  for (const auto& [node, part] : fox) names.insert(part);
  for (const char* name : {"head", "neck", "tail", "left upper foreleg", "right lower foreleg", "left forefoot",
                           "right upper hind leg", "left lower hind leg", "right hind foot"}) {
    CHECK_MESSAGE(names.count(name) == 1, name);
  }
  names.clear();
  for (const auto& [node, part] : part_names_by_node(insect(3, true))) names.insert(part);
  for (const char* name : {"body", "head", "left leg 1 thigh", "right leg 3 thigh", "left leg 2 shin"}) {
    CHECK_MESSAGE(names.count(name) == 1, name);
  }
}

TEST_CASE("bones without any role are parts of their names, at most 255 with the rest") {
  Character character;
  Roles roles;
  for (Index i = 0; i < 300; ++i) {
    character.rig.nodes.push_back({i == 7 ? "" : "rock" + std::to_string(i)});
    character.rig.bones.push_back({i, Affine::Identity()});
    roles.of_node.push_back({"other", -1, {}});
    VertexWeights weights;
    weights.joint[0] = i;
    weights.weight[0] = 1;
    character.rig.weights.push_back(weights);
    character.source_positions.push_back(Vec3::Zero());
    character.source_triangles.push_back({i, i, i});
    if (i >= 200) character.source_triangles.push_back({i, i, i});
  }
  const BodyParts parts = find_body_parts(character, roles, {}, {}, {});
  check_whole(character, parts);
  REQUIRE(parts.parts.size() == 255);
  CHECK(parts.parts[7].name == "bone 7");
  CHECK(parts.parts[253].name == "rock299");
  CHECK(parts.parts[254].name == "rest of the body");
  CHECK(parts.parts[254].bone == -1);
}

TEST_CASE("a triangle follows the part that moves it most, and where nothing moves it, its region names it") {
  Character character = one_triangle_a_bone(named_rig(kMixamo));
  const Roles roles = roles_of(named_rig(kMixamo));
  const auto bone = [&](const char* name) {
    const auto found = std::find_if(character.rig.bones.begin(), character.rig.bones.end(),
                                    [&](const Bone& b) { return character.rig.nodes[b.node].name == name; });
    REQUIRE(found != character.rig.bones.end());
    return static_cast<Index>(found - character.rig.bones.begin());
  };
  VertexWeights shared;
  shared.joint = {bone("mixamorig:LeftForeArm"), bone("mixamorig:LeftHand"), bone("mixamorig:LeftHandIndex3")};
  shared.weight = {0.4, 0.35, 0.25};  // hand and finger together are stronger than the strongest bone
  character.rig.weights[0] = shared;
  character.rig.weights[1] = {};
  VertexWeights tied;
  tied.joint = {bone("mixamorig:LeftUpLeg"), bone("mixamorig:Hips")};
  tied.weight = {0.5, 0.5};
  character.rig.weights[2] = tied;
  character.skin.positions = character.source_positions;
  character.skin.triangles = character.source_triangles;
  for (Index v = 0; v < character.source_positions.size(); ++v) {
    character.skin_of_source.push_back(v);
    character.skin_source_triangle.push_back(v);
  }
  Regions regions;
  Limb limb;
  limb.name = "left_arm";
  limb.side = Side::kLeft;
  regions.limbs.push_back(limb);
  regions.of_skin.assign(character.skin.triangles.size(), 0);
  const BodyParts parts = find_body_parts(character, roles, regions, {}, {});
  check_whole(character, parts);
  CHECK(parts.parts[parts.of_triangle[0]].name == "left hand");
  CHECK(parts.parts[parts.of_triangle[2]].name == "hips");
  const BodyPart& region = parts.parts[parts.of_triangle[1]];
  CHECK(region.name == "left arm");
  CHECK(region.side == Side::kLeft);
  CHECK(region.bone == -1);
  character.rig = {};
  const BodyParts still = find_body_parts(character, {}, regions, {}, {});
  CHECK(part_names(still) == Names{"left arm", "torso"});
  CHECK(still.of_triangle == regions.of_skin);
}

TEST_CASE("characters of SPHERECHAIN_TEST_DATA have the parts that people see") {
  if (std::getenv("SPHERECHAIN_TEST_DATA") == nullptr) {
    MESSAGE("skipped: SPHERECHAIN_TEST_DATA names no folder of rigged characters");
    return;
  }
  const Shown boxer = character_of_test_data("mh_boxing.glb");
  Names names = part_names(boxer.parts), wanted = kHumanParts;
  std::sort(names.begin(), names.end());
  std::sort(wanted.begin(), wanted.end());
  CHECK(names == wanted);
  CHECK(bone_name(boxer, "left hand") == "LeftHand");
  CHECK(bone_name(boxer, "right thigh") == "RightUpLeg");
  CHECK(bone_name(boxer, "hips") == "Hips");
  CHECK(bone_name(boxer, "chest") == "Spine1");
  const auto across = [&](const char* name) { return middle_of(boxer.character, boxer.parts, name).x(); };
  CHECK(across("left hand") > across("left forearm"));
  CHECK(across("right hand") < across("right forearm"));

  const Shown cesium = character_of_test_data("CesiumMan.glb");
  CHECK(bone_name(cesium, "left forearm") == "Skeleton_arm_joint_L__3_");
  CHECK(bone_name(cesium, "right foot") == "leg_joint_R_3");
  CHECK(cesium.parts.parts.size() == 17);  // without clavicles

  const Shown fox = character_of_test_data("Fox.glb");
  CHECK(bone_name(fox, "tail") == "b_Tail01_012");
  CHECK(bone_name(fox, "left upper foreleg") == "b_LeftUpperArm_09");
  CHECK(bone_name(fox, "right hind foot") == "b_RightFoot01_021");
  CHECK(part_called(fox.parts, "right hind foot").side == Side::kRight);

  const Shown barbarian = character_of_test_data("KayKit_Barbarian.glb");
  CHECK(bone_name(barbarian, "left hand") == "wrist.l");
  CHECK(bone_name(barbarian, "head") == "head");
  CHECK(bone_name(barbarian, "right thigh") == "upperleg.r");
  CHECK(bone_name(barbarian, "1H_Axe_Offhand") == "1H_Axe_Offhand");
  CHECK(bone_name(barbarian, "hat") == "Barbarian_Hat");
}
