// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include "role_cases.h"

using namespace spherechain::baker;

TEST_CASE("roles of a Mixamo rig whose exporter dropped the colon") {
  std::string tree = kMixamo;
  for (std::size_t at = tree.find(':'); at != std::string::npos; at = tree.find(':')) tree.erase(at, 1);
  check_roles(named_rig(tree));
}

TEST_CASE("a namespace is no part of a name") {
  std::string tree = kMixamo;
  for (std::size_t at = tree.find("mixamorig:"); at != std::string::npos; at = tree.find("mixamorig:")) {
    tree.replace(at, 9, "RightHandRig");
  }
  check_roles(named_rig(tree));
}

TEST_CASE("roles of a rig whose exporter hung every limb's bones on the root") {
  const NamedRig rig = named_rig(R"(
rig = !root
  DEF-spine = pelvis
    DEF-spine.001 = spine
      DEF-spine.003 = chest
        DEF-spine.006 = head
        DEF-shoulder.L = left_clavicle
        DEF-shoulder.R = right_clavicle
        DEF-upper_arm.L = left_shoulder
        DEF-upper_arm.R = right_shoulder
    DEF-thigh.L = left_hip
    DEF-thigh.R = right_hip
  DEF-forearm.L = left_elbow
  DEF-forearm.R = right_elbow
  DEF-hand.L = left_wrist
  DEF-hand.R = right_wrist
  DEF-shin.L = left_knee
  DEF-shin.R = right_knee
  DEF-foot.L = left_ankle
    DEF-toe.L = left_toe
  DEF-foot.R = right_ankle
    DEF-toe.R = right_toe
)");
  check_roles(rig);
  CHECK(roles_of(rig).limbs.size() == 4);
}

TEST_CASE("roles of joints numbered down the limb, whichever way the numbers run") {
  check_roles(named_rig(R"(
Armature = !root
  Skeleton_torso_joint_1 = pelvis
    Skeleton_torso_joint_2 = spine
      torso_joint_3 = chest
        Skeleton_neck_joint_1 = neck
          Skeleton_neck_joint_2 = head
        Skeleton_arm_joint_L__4_ = left_shoulder
          Skeleton_arm_joint_L__3_ = left_elbow
            Skeleton_arm_joint_L__2_ = left_wrist
        Skeleton_arm_joint_R = right_shoulder
          Skeleton_arm_joint_R__2_ = right_elbow
            Skeleton_arm_joint_R__3_ = right_wrist
    leg_joint_L_1 = left_hip
      leg_joint_L_2 = left_knee
        leg_joint_L_3 = left_ankle
          leg_joint_L_5 = left_toe
    leg_joint_R_1 = right_hip
      leg_joint_R_2 = right_knee
        leg_joint_R_3 = right_ankle
          leg_joint_R_5 = right_toe
)"));
}

TEST_CASE("a numbered arm may begin with its clavicle: the two long bones are upper and fore arm") {
  check_roles(named_rig(R"(
Hips = pelvis
  Chest = chest
    Head = head
    Arm1_L = left_clavicle
      Arm2_L = left_shoulder
        Arm3_L = left_elbow
          Arm4_L = left_wrist
    Arm1_R = right_clavicle
      Arm2_R = right_shoulder
        Arm3_R = right_elbow
          Arm4_R = right_wrist
  Leg1_L = left_hip
    Leg2_L = left_knee
      Leg3_L = left_ankle
  Leg1_R = right_hip
    Leg2_R = right_knee
      Leg3_R = right_ankle
)"));
}

TEST_CASE("a pelvis above both legs is of the trunk though its name has a side, a tail on the head is hair") {
  check_roles(named_rig(R"(
B_Root_Pelvis_L = spine
  B_LowerPelvis = pelvis
    B_Hip_Left = left_hip
      B_Knee_Left = left_knee
        B_Ankle_Left = left_ankle
    B_Hip_Right = right_hip
      B_Knee_Right = right_knee
        B_Ankle_Right = right_ankle
  B_Spine1 = chest
    B_UpperArm_Left = left_shoulder
      B_ForeArm_Left = left_elbow
        B_Hand_Left = left_wrist
    B_UpperArm_Right = right_shoulder
      B_ForeArm_Right = right_elbow
        B_Hand_Right = right_wrist
    B_Head = head
      B_PTail1 = head_part
)"));
}

TEST_CASE("names decide left and right; where feet contradict them, the reason says so") {
  NamedRig rig = named_rig(kMixamo);
  for (Vec3& p : rig.positions) p.z() = -p.z();
  for (Bone& bone : rig.rig.bones) bone.inverse_bind.translation().z() *= -1;
  const Roles roles = roles_of(rig);
  const NodeRole& hip = roles.of_node[limb_called(roles, "left_leg").nodes[0]];
  CHECK(rig.rig.nodes[limb_called(roles, "left_leg").nodes[0]].name == "mixamorig:LeftUpLeg");
  CHECK(hip.reason.find("though it is on the other one") != std::string::npos);
  const Roles right = roles_of(named_rig(kMixamo));
  for (const NodeRole& role : right.of_node) CHECK(role.reason.find("though") == std::string::npos);
}
