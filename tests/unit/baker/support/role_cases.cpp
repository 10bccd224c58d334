// SPDX-License-Identifier: GPL-3.0-or-later
#include "role_cases.h"

#include <doctest/doctest.h>

#include <algorithm>

using namespace spherechain::baker;

const char* const kMixamo = R"(
mixamorig:Hips = pelvis
  mixamorig:Spine = spine
    mixamorig:Spine1 = spine
      mixamorig:Spine2 = chest
        mixamorig:Neck = neck
          mixamorig:Head = head
            mixamorig:HeadTop_End = !other
        mixamorig:LeftShoulder = left_clavicle
          mixamorig:LeftArm = left_shoulder
            mixamorig:LeftForeArm = left_elbow
              mixamorig:LeftHand = left_wrist
                mixamorig:LeftHandIndex1 = left_finger
                  mixamorig:LeftHandIndex2 = left_finger
                    mixamorig:LeftHandIndex3 = left_finger
                mixamorig:LeftHandThumb1 = left_finger
                  mixamorig:LeftHandThumb2 = left_finger
        mixamorig:RightShoulder = right_clavicle
          mixamorig:RightArm = right_shoulder
            mixamorig:RightForeArm = right_elbow
              mixamorig:RightHand = right_wrist
                mixamorig:RightHandIndex1 = right_finger
                  mixamorig:RightHandIndex2 = right_finger
                    mixamorig:RightHandIndex3 = right_finger
                mixamorig:RightHandThumb1 = right_finger
                  mixamorig:RightHandThumb2 = right_finger
  mixamorig:LeftUpLeg = left_hip
    mixamorig:LeftLeg = left_knee
      mixamorig:LeftFoot = left_ankle
        mixamorig:LeftToeBase = left_toe
          mixamorig:LeftToe_End = !left_toe
  mixamorig:RightUpLeg = right_hip
    mixamorig:RightLeg = right_knee
      mixamorig:RightFoot = right_ankle
        mixamorig:RightToeBase = right_toe
          mixamorig:RightToe_End = !right_toe
)";

const char* const kCapture = R"(
Hips = !pelvis
  LHipJoint = !other
    LeftUpLeg = !left_hip
      LeftLeg = !left_knee
        LeftFoot = !left_ankle
          LeftToeBase = !left_toe
  RHipJoint = !other
    RightUpLeg = !right_hip
      RightLeg = !right_knee
        RightFoot = !right_ankle
          RightToeBase = !right_toe
  LowerBack = !spine
    Spine = !spine
      Spine1 = !chest
        Neck = !neck
          Neck1 = !neck
            Head = !head
        LeftShoulder = !left_clavicle
          LeftArm = !left_shoulder
            LeftForeArm = !left_elbow
              LeftHand = !left_wrist
                LeftFingerBase = !left_finger
                  LFingers = !left_finger
                LThumb = !left_finger
        RightShoulder = !right_clavicle
          RightArm = !right_shoulder
            RightForeArm = !right_elbow
              RightHand = !right_wrist
                RightFingerBase = !right_finger
                  RFingers = !right_finger
                RThumb = !right_finger
)";

const char* const kFox = R"(
root = !root
  b_Hip_01 = pelvis
    b_Spine01_02 = spine
      b_Spine02_03 = chest
        b_Neck_04 = neck
          b_Head_05 = head
          b_RightUpperArm_06 = right_shoulder
            b_RightForeArm_07 = right_elbow
              b_RightHand_08 = right_wrist
          b_LeftUpperArm_09 = left_shoulder
            b_LeftForeArm_010 = left_elbow
              b_LeftHand_011 = left_wrist
    b_Tail01_012 = tail_1
      b_Tail02_013 = tail_2
        b_Tail03_014 = tail_3
    b_LeftLeg01_015 = left_hip
      b_LeftLeg02_016 = left_knee
        b_LeftFoot01_017 = left_ankle
          b_LeftFoot02_018 = left_toe
    b_RightLeg01_019 = right_hip
      b_RightLeg02_020 = right_knee
        b_RightFoot01_021 = right_ankle
          b_RightFoot02_022 = right_toe
)";

Roles roles_of(const NamedRig& rig) { return find_roles(rig.rig, rig.positions); }

void check_roles(const NamedRig& rig, BodyKind kind) {
  const Roles roles = roles_of(rig);
  CHECK(roles.kind == kind);
  REQUIRE(roles.of_node.size() == rig.expected.size());
  for (std::size_t n = 0; n < rig.expected.size(); ++n) {
    CAPTURE(rig.rig.nodes[n].name);
    CHECK_FALSE(roles.of_node[n].reason.empty());
    CHECK(roles.of_node[n].reason.find("the rig's shape") == std::string::npos);
    CHECK(roles.of_node[n].role == rig.expected[n]);
  }
}

const RoleLimb& limb_called(const Roles& roles, std::string_view name) {
  const auto found =
      std::find_if(roles.limbs.begin(), roles.limbs.end(), [&](const RoleLimb& l) { return l.name == name; });
  REQUIRE(found != roles.limbs.end());
  return *found;
}

Names names_of(const NamedRig& rig, const std::vector<int>& nodes) {
  Names out;
  for (const int n : nodes) out.push_back(rig.rig.nodes[n].name);
  return out;
}

Names summary_of(const NamedRig& rig) {
  const Roles roles = roles_of(rig);
  Names out;
  for (std::size_t n = 0; n < rig.rig.nodes.size(); ++n) {
    const NodeRole& role = roles.of_node[n];
    out.push_back(rig.rig.nodes[n].name + " " + role.role + " " + (role.limb < 0 ? "" : roles.limbs[role.limb].name));
  }
  std::sort(out.begin(), out.end());
  return out;
}

NamedRig insect(int pairs, bool is_named) {
  NamedRig out;
  const auto add = [&](const std::string& name, int parent, const Vec3& at) {
    Node node;
    node.name = is_named ? name : "joint_" + std::to_string(out.rig.nodes.size());
    node.parent = parent;
    Affine inverse_bind = Affine::Identity();
    inverse_bind.translation() = -at;
    const auto index = static_cast<Index>(out.rig.nodes.size());
    out.rig.nodes.push_back(node);
    out.rig.bones.push_back({index, inverse_bind});
    VertexWeights weights;
    weights.joint[0] = index;
    weights.weight[0] = 1;
    out.rig.weights.push_back(weights);
    out.positions.push_back(at);
    out.expected.emplace_back();
    return static_cast<int>(index);
  };
  const int body = add("Body", -1, {0, 1, 0});
  add("Head", body, {0, 1.1, 2});
  const int abdomen = add("Abdomen", body, {0, 1.2, -1.5});
  add("Abdomen2", abdomen, {0, 1.2, -3});
  for (int p = 0; p < pairs; ++p) {
    const double z = 1 - 0.7 * p;
    for (const double side : {1.0, -1.0}) {
      const std::string end = std::to_string(p + 1) + (side > 0 ? ".L" : ".R");
      const int coxa = add("Leg" + end, body, {side * 0.4, 1, z});
      const int knee = add("Leg" + end + ".001", coxa, {side * 1.4, 1.6, 1.6 * z});
      add("Leg" + end + ".002", knee, {side * 2.2, 0, 2 * z});
    }
  }
  return out;
}
