// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>

#include "mesh/error.h"
#include "named_rig.h"

using namespace spherechain::baker;

namespace {

Roles roles_of(const NamedRig& rig) { return find_roles(rig.rig, rig.positions); }

void check_roles(const NamedRig& rig, BodyKind kind = BodyKind::kBiped) {
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

const RoleLimb& limb(const Roles& roles, const std::string& name) {
  const auto found =
      std::find_if(roles.limbs.begin(), roles.limbs.end(), [&](const RoleLimb& l) { return l.name == name; });
  REQUIRE(found != roles.limbs.end());
  return *found;
}

std::vector<std::string> names(const NamedRig& rig, const std::vector<int>& nodes) {
  std::vector<std::string> out;
  for (const int n : nodes) out.push_back(rig.rig.nodes[n].name);
  return out;
}

// What does not depend on a node's number: its name, role and limb's name.
std::vector<std::string> summary(const NamedRig& rig) {
  const Roles roles = roles_of(rig);
  std::vector<std::string> out;
  for (std::size_t n = 0; n < rig.rig.nodes.size(); ++n) {
    const NodeRole& role = roles.of_node[n];
    out.push_back(rig.rig.nodes[n].name + " " + role.role + " " + (role.limb < 0 ? "" : roles.limbs[role.limb].name));
  }
  std::sort(out.begin(), out.end());
  return out;
}

using Names = std::vector<std::string>;

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

}  // namespace

TEST_CASE("roles of a Mixamo rig: LeftArm is the upper arm, LeftShoulder the clavicle, LeftLeg the shin") {
  const NamedRig rig = named_rig(kMixamo);
  check_roles(rig);
  const Roles roles = roles_of(rig);
  CHECK(names(rig, roles.trunk) == Names{"mixamorig:Hips", "mixamorig:Spine", "mixamorig:Spine1", "mixamorig:Spine2"});
  CHECK(names(rig, roles.neck_head) == Names{"mixamorig:Neck", "mixamorig:Head"});
  REQUIRE(roles.limbs.size() == 4);
  CHECK(roles.limbs[0].name == "left_arm");
  CHECK(roles.limbs[1].name == "right_arm");
  CHECK(roles.limbs[2].name == "left_leg");
  CHECK(roles.limbs[3].name == "right_leg");
  const RoleLimb& arm = roles.limbs[0];
  CHECK(arm.left);
  CHECK(arm.top);
  CHECK(rig.rig.nodes[arm.girdle].name == "mixamorig:LeftShoulder");
  CHECK(rig.rig.nodes[arm.nodes.front()].name == "mixamorig:LeftArm");
  CHECK(rig.rig.nodes[arm.nodes[arm.extremity]].name == "mixamorig:LeftHand");
  CHECK(rig.rig.nodes[arm.nodes.back()].name == "mixamorig:LeftHandIndex3");
}

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

TEST_CASE("roles of a VRM rig: coat and sleeves named after limbs are none") {
  check_roles(named_rig(R"(
Root = !root
  J_Bip_C_Hips = pelvis
    J_Bip_C_Spine = spine
      J_Bip_C_Chest = spine
        J_Bip_C_UpperChest = chest
          J_Bip_C_Neck = neck
            J_Bip_C_Head = head
              J_Adj_L_FaceEye = eye
              J_Adj_R_FaceEye = eye
              J_Sec_Hair1_01 = hair
                J_Sec_Hair2_01 = hair
          J_Sec_L_Bust1 = other
          J_Bip_L_Shoulder = left_clavicle
            J_Bip_L_UpperArm = left_shoulder
              J_Sec_L_TopsUpperArmInside_01 = other
              J_Bip_L_LowerArm = left_elbow
                J_Bip_L_Hand = left_wrist
                  J_Bip_L_Thumb1 = left_finger
                  J_Bip_L_Middle1 = left_finger
                    J_Bip_L_Middle2 = left_finger
          J_Bip_R_Shoulder = right_clavicle
            J_Bip_R_UpperArm = right_shoulder
              J_Bip_R_LowerArm = right_elbow
                J_Bip_R_Hand = right_wrist
                  J_Bip_R_Middle1 = right_finger
    J_Sec_L_SkirtFront0_01_UpperLeg = other
      J_Sec_L_SkirtFront1_01_UpperLeg = other
    Skirt_L_UpperLeg = other
    J_Bip_L_UpperLeg = left_hip
      J_Bip_L_LowerLeg = left_knee
        J_Bip_L_Foot = left_ankle
          J_Bip_L_ToeBase = left_toe
    J_Bip_R_UpperLeg = right_hip
      J_Bip_R_LowerLeg = right_knee
        J_Bip_R_Foot = right_ankle
          J_Bip_R_ToeBase = right_toe
)"));
}

TEST_CASE("roles of the MakeHuman default rig: doubled bones, a shoulder after the clavicle") {
  const NamedRig rig = named_rig(R"(
root = pelvis
  spine05 = spine
    spine04 = spine
      spine03 = spine
        spine02 = spine
          breast.L = other
          breast.R = other
          spine01 = chest
            clavicle.L = left_clavicle
              shoulder01.L = other
                upperarm01.L = left_shoulder
                  upperarm02.L = twist
                    lowerarm01.L = left_elbow
                      lowerarm02.L = twist
                        wrist.L = left_wrist
                          metacarpal2.L = left_finger
                            finger2-1.L = left_finger
                              finger2-2.L = left_finger
                          finger1-1.L = left_finger
            clavicle.R = right_clavicle
              shoulder01.R = other
                upperarm01.R = right_shoulder
                  upperarm02.R = twist
                    lowerarm01.R = right_elbow
                      lowerarm02.R = twist
                        wrist.R = right_wrist
                          metacarpal2.R = right_finger
                            finger2-1.R = right_finger
                              finger2-2.R = right_finger
                          finger1-1.R = right_finger
            neck01 = neck
              neck02 = neck
                neck03 = neck
                  head = head
                    jaw = jaw
                      tongue00 = head_part
                    eye.L = eye
                    eye.R = eye
                    levator02.L = head_part
  pelvis.L = other
    upperleg01.L = left_hip
      upperleg02.L = twist
        lowerleg01.L = left_knee
          lowerleg02.L = twist
            foot.L = left_ankle
              toe1-1.L = left_toe
                toe1-2.L = left_toe
  pelvis.R = other
    upperleg01.R = right_hip
      upperleg02.R = twist
        lowerleg01.R = right_knee
          lowerleg02.R = twist
            foot.R = right_ankle
              toe1-1.R = right_toe
                toe1-2.R = right_toe
)");
  check_roles(rig);
  const Roles roles = roles_of(rig);
  CHECK(rig.rig.nodes[limb(roles, "left_leg").girdle].name == "pelvis.L");
  CHECK(rig.rig.nodes[limb(roles, "left_arm").girdle].name == "clavicle.L");
}

TEST_CASE("roles of a CMU capture: hip joints are no thighs") {
  const NamedRig rig = named_rig(kCapture);
  check_roles(rig);
  const Roles roles = roles_of(rig);
  CHECK(rig.rig.nodes[limb(roles, "left_leg").girdle].name == "LHipJoint");
}

TEST_CASE("roles of a capture whose LeftShoulder is the upper arm and LeftHip the thigh") {
  check_roles(named_rig(R"(
Hips = !pelvis
  Ab = !spine
    Chest = !chest
      Neck = !neck
        Head = !head
      LeftCollar = !left_clavicle
        LeftShoulder = !left_shoulder
          LeftElbow = !left_elbow
            LeftWrist = !left_wrist
      RightCollar = !right_clavicle
        RightShoulder = !right_shoulder
          RightElbow = !right_elbow
            RightWrist = !right_wrist
  LeftHip = !left_hip
    LeftKnee = !left_knee
      LeftAnkle = !left_ankle
        LeftToes = !left_toe
  RightHip = !right_hip
    RightKnee = !right_knee
      RightAnkle = !right_ankle
        RightToes = !right_toe
)"));
}

TEST_CASE("roles of a 3ds Max Biped: thighs hang on the spine, clavicles on the neck") {
  check_roles(named_rig(R"(
Bip01 = !root
  Bip01 Footsteps = !control
  Bip01 Pelvis = pelvis
    Bip01 Spine = spine
      Bip01 L Thigh = left_hip
        Bip01 L Calf = left_knee
          Bip01 L Foot = left_ankle
            Bip01 L Toe0 = left_toe
              Bip01 L Toe0Nub = !left_toe
      Bip01 R Thigh = right_hip
        Bip01 R Calf = right_knee
          Bip01 R Foot = right_ankle
            Bip01 R Toe0 = right_toe
              Bip01 R Toe0Nub = !right_toe
      Bip01 Spine1 = chest
        Bip01 Neck = neck
          Bip01 L Clavicle = left_clavicle
            Bip01 L UpperArm = left_shoulder
              Bip01 L Forearm = left_elbow
                Bip01 L ForeTwist = twist
                Bip01 L Hand = left_wrist
                  Bip01 L Finger0 = left_finger
                    Bip01 L Finger01 = left_finger
          Bip01 R Clavicle = right_clavicle
            Bip01 R UpperArm = right_shoulder
              Bip01 R Forearm = right_elbow
                Bip01 R ForeTwist = twist
                Bip01 R Hand = right_wrist
                  Bip01 R Finger0 = right_finger
                    Bip01 R Finger01 = right_finger
          Bip01 Head = head
            Bip01 HeadNub = !other
            Bip01 Ponytail1 = hair
)"));
}

const char* const kRigify = R"(
rig = !root
  root = !root
    DEF-spine = pelvis
      DEF-pelvis.L = other
      DEF-pelvis.R = other
      DEF-spine.001 = spine
        DEF-spine.002 = spine
          DEF-spine.003 = chest
            DEF-spine.004 = neck
              DEF-spine.005 = neck
                DEF-spine.006 = head
            DEF-shoulder.L = left_clavicle
              DEF-upper_arm.L = left_shoulder
                DEF-upper_arm.L.001 = twist
                  DEF-forearm.L = left_elbow
                    DEF-forearm.L.001 = twist
                      DEF-hand.L = left_wrist
                        ORG-palm.01.L = !left_finger
                          DEF-palm.01.L = left_finger
                          DEF-f_index.01.L = left_finger
                            DEF-f_index.02.L = left_finger
                        DEF-thumb.01.L = left_finger
            DEF-shoulder.R = right_clavicle
              DEF-upper_arm.R = right_shoulder
                DEF-upper_arm.R.001 = twist
                  DEF-forearm.R = right_elbow
                    DEF-forearm.R.001 = twist
                      DEF-hand.R = right_wrist
                        DEF-f_index.01.R = right_finger
                          DEF-f_index.02.R = right_finger
      DEF-thigh.L = left_hip
        DEF-thigh.L.001 = twist
          DEF-shin.L = left_knee
            DEF-shin.L.001 = twist
              DEF-foot.L = left_ankle
                DEF-toe.L = left_toe
      DEF-thigh.R = right_hip
        DEF-thigh.R.001 = twist
          DEF-shin.R = right_knee
            DEF-shin.R.001 = twist
              DEF-foot.R = right_ankle
                DEF-toe.R = right_toe
    MCH-hand_ik.parent.L = !control
      hand_ik.L = !control
    foot_ik.L = !control
)";

TEST_CASE("roles of a Rigify rig: deform bones, not controls") { check_roles(named_rig(kRigify)); }

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

TEST_CASE("roles of an Unreal rig: twist bones beside the fore arm") {
  check_roles(named_rig(R"(
root = !root
  pelvis = pelvis
    spine_01 = spine
      spine_02 = spine
        spine_03 = chest
          clavicle_l = left_clavicle
            upperarm_l = left_shoulder
              lowerarm_l = left_elbow
                hand_l = left_wrist
                  index_01_l = left_finger
                    index_02_l = left_finger
                  thumb_01_l = left_finger
                lowerarm_twist_01_l = twist
              upperarm_twist_01_l = twist
          clavicle_r = right_clavicle
            upperarm_r = right_shoulder
              lowerarm_r = right_elbow
                hand_r = right_wrist
                  index_01_r = right_finger
                    index_02_r = right_finger
                lowerarm_twist_01_r = twist
              upperarm_twist_01_r = twist
          neck_01 = neck
            head = head
    thigh_l = left_hip
      calf_l = left_knee
        calf_twist_01_l = twist
        foot_l = left_ankle
          ball_l = left_toe
      thigh_twist_01_l = twist
    thigh_r = right_hip
      calf_r = right_knee
        calf_twist_01_r = twist
        foot_r = right_ankle
          ball_r = right_toe
      thigh_twist_01_r = twist
  ik_foot_root = !control
    ik_foot_l = !control
    ik_foot_r = !control
  ik_hand_root = !control
    ik_hand_gun = !control
      ik_hand_l = !control
)"));
}

TEST_CASE("roles of an SMPL rig: L_Hip is the thigh, L_Foot the toes") {
  check_roles(named_rig(R"(
Pelvis = pelvis
  L_Hip = left_hip
    L_Knee = left_knee
      L_Ankle = left_ankle
        L_Foot = left_toe
  R_Hip = right_hip
    R_Knee = right_knee
      R_Ankle = right_ankle
        R_Foot = right_toe
  Spine1 = spine
    Spine2 = spine
      Spine3 = chest
        Neck = neck
          Head = head
        L_Collar = left_clavicle
          L_Shoulder = left_shoulder
            L_Elbow = left_elbow
              L_Wrist = left_wrist
                L_Hand = left_finger
        R_Collar = right_clavicle
          R_Shoulder = right_shoulder
            R_Elbow = right_elbow
              R_Wrist = right_wrist
                R_Hand = right_finger
)"));
}

TEST_CASE("roles of an SMPL rig in small letters without a separator before the side") {
  check_roles(named_rig(R"(
pelvis = pelvis
  lefthip = left_hip
    leftknee = left_knee
      leftfoot = left_ankle
  righthip = right_hip
    rightknee = right_knee
      rightfoot = right_ankle
  spine = chest
    head = head
    lshoulder = left_shoulder
      lelbow = left_elbow
        lhand = left_wrist
    rshoulder = right_shoulder
      relbow = right_elbow
        rhand = right_wrist
)"));
}

TEST_CASE("roles of a Unity humanoid") {
  check_roles(named_rig(R"(
Armature = !root
  Hips = pelvis
    Spine = spine
      Chest = spine
        UpperChest = chest
          Neck = neck
            Head = head
              LeftEye = eye
              RightEye = eye
              Jaw = jaw
          LeftShoulder = left_clavicle
            LeftUpperArm = left_shoulder
              LeftLowerArm = left_elbow
                LeftHand = left_wrist
                  Left Thumb Proximal = left_finger
                  Left Index Proximal = left_finger
                    Left Index Intermediate = left_finger
          RightShoulder = right_clavicle
            RightUpperArm = right_shoulder
              RightLowerArm = right_elbow
                RightHand = right_wrist
                  Right Index Proximal = right_finger
                    Right Index Intermediate = right_finger
    LeftUpperLeg = left_hip
      LeftLowerLeg = left_knee
        LeftFoot = left_ankle
          LeftToes = left_toe
    RightUpperLeg = right_hip
      RightLowerLeg = right_knee
        RightFoot = right_ankle
          RightToes = right_toe
)"));
}

TEST_CASE("roles of a DAZ figure: the pelvis is beside the spine, bends and twists take turns") {
  check_roles(named_rig(R"(
hip = pelvis
  pelvis = other
    lThighBend = left_hip
      lThighTwist = twist
        lShin = left_knee
          lFoot = left_ankle
            lMetatarsals = left_toe
              lToe = left_toe
    rThighBend = right_hip
      rThighTwist = twist
        rShin = right_knee
          rFoot = right_ankle
            rMetatarsals = right_toe
              rToe = right_toe
  abdomenLower = spine
    abdomenUpper = spine
      chestLower = spine
        chestUpper = chest
          lCollar = left_clavicle
            lShldrBend = left_shoulder
              lShldrTwist = twist
                lForearmBend = left_elbow
                  lForearmTwist = twist
                    lHand = left_wrist
                      lThumb1 = left_finger
          rCollar = right_clavicle
            rShldrBend = right_shoulder
              rShldrTwist = twist
                rForearmBend = right_elbow
                  rForearmTwist = twist
                    rHand = right_wrist
                      rThumb1 = right_finger
          neckLower = neck
            neckUpper = neck
              head = head
)"));
}

TEST_CASE("roles of a KayKit rig: handles of weapons, controls without skin and mesh nodes are no limbs") {
  check_roles(named_rig(R"(
Rig = !root
  Barbarian_ArmLeft = !other
  Barbarian_Head = !other
  root = !root
    hips = pelvis
      spine = spine
        chest = chest
          upperarm.l = left_shoulder
            lowerarm.l = left_elbow
              wrist.l = left_wrist
                hand.l = left_finger
                  handslot.l = attachment
                    1H_Axe = !other
          upperarm.r = right_shoulder
            lowerarm.r = right_elbow
              wrist.r = right_wrist
                hand.r = right_finger
                  handslot.r = attachment
          head = head
            Barbarian_Hat = !other
      upperleg.l = left_hip
        lowerleg.l = left_knee
          foot.l = left_ankle
            toes.l = left_toe
      upperleg.r = right_hip
        lowerleg.r = right_knee
          foot.r = right_ankle
            toes.r = right_toe
    kneeIK.l = !control
    control-toe-roll.l = !control
      control-heel-roll.l = !control
        heelIK.l = !control
        IK-foot.l = !control
    handIK.l = !control
)"));
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

TEST_CASE("a quadruped is one though its names are a human's, and has a tail") {
  const NamedRig rig = named_rig(kFox, Body::kFox);
  check_roles(rig, BodyKind::kQuadruped);
  const Roles roles = roles_of(rig);
  REQUIRE(roles.limbs.size() == 5);
  CHECK(roles.limbs[0].name == "left_foreleg");
  CHECK(roles.limbs[1].name == "right_foreleg");
  CHECK(roles.limbs[2].name == "left_hindleg");
  CHECK(roles.limbs[3].name == "right_hindleg");
  CHECK(roles.limbs[4].name == "tail");
  CHECK(names(rig, roles.limbs[4].nodes) == Names{"b_Tail01_012", "b_Tail02_013", "b_Tail03_014"});
  CHECK(names(rig, roles.trunk) == Names{"b_Hip_01", "b_Spine01_02", "b_Spine02_03"});
}

TEST_CASE("a quadruped rooted in its middle, legs named front and hind") {
  const NamedRig rig = named_rig(R"(
Root = other
  Spine_Back01 = spine
    Pelvis = pelvis
      Tail01 = tail_1
        Tail02 = tail_2
      HindLeg_L_01 = left_hip
        HindLeg_L_02 = left_knee
          HindLeg_L_03 = left_ankle
            HindLeg_L_04 = left_toe
      HindLeg_R_01 = right_hip
        HindLeg_R_02 = right_knee
          HindLeg_R_03 = right_ankle
            HindLeg_R_04 = right_toe
  Spine_Front01 = chest
    Neck = head
      Ear_L = head_part
      Ear_R = head_part
    ForeLeg_L_01 = left_shoulder
      ForeLeg_L_02 = left_elbow
        ForeLeg_L_03 = left_wrist
    ForeLeg_R_01 = right_shoulder
      ForeLeg_R_02 = right_elbow
        ForeLeg_R_03 = right_wrist
)",
                                 Body::kFox);
  const Roles roles = roles_of(rig);
  CHECK(roles.kind == BodyKind::kQuadruped);
  for (std::size_t n = 1; n < rig.expected.size(); ++n) {
    CAPTURE(rig.rig.nodes[n].name);
    CHECK(roles.of_node[n].role == rig.expected[n]);
  }
  CHECK(names(rig, roles.trunk) == Names{"Pelvis", "Spine_Back01", "Root", "Spine_Front01"});
}

namespace {

// Six or more legs on one body, and a head.
NamedRig insect(int pairs, bool named) {
  NamedRig out;
  const auto add = [&](const std::string& name, int parent, const Vec3& at) {
    Node node;
    node.name = named ? name : "joint_" + std::to_string(out.rig.nodes.size());
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

}  // namespace

TEST_CASE("six and eight legs are numbered from the front") {
  for (const int pairs : {3, 4}) {
    const NamedRig rig = insect(pairs, true);
    const Roles roles = roles_of(rig);
    CHECK(roles.kind == BodyKind::kOther);
    REQUIRE(roles.limbs.size() == static_cast<std::size_t>(2 * pairs));
    for (int p = 0; p < pairs; ++p) {
      const std::string number = std::to_string(p + 1);
      CHECK(roles.limbs[2 * p].name == "left_leg_" + number);
      CHECK(roles.limbs[2 * p + 1].name == "right_leg_" + number);
      CHECK(names(rig, roles.limbs[2 * p].nodes) ==
            Names{"Leg" + number + ".L", "Leg" + number + ".L.001", "Leg" + number + ".L.002"});
      CHECK(roles.of_node[roles.limbs[2 * p].nodes[0]].role == "limb");
    }
    CHECK(roles.limbs.front().top);
    CHECK_FALSE(roles.limbs.back().top);
  }
}

TEST_CASE("six legs without names are found by the plane of symmetry") {
  const NamedRig rig = insect(3, false);
  const Roles roles = roles_of(rig);
  CHECK(roles.kind == BodyKind::kOther);
  REQUIRE(roles.limbs.size() == 7);
  CHECK(roles.limbs[6].name == "tail");  // the abdomen
  CHECK(roles.of_node[1].role == "head");
  const std::vector<Vec3> where = rest_positions(rig.rig);
  for (std::size_t i = 0; i < 6; ++i) {
    const RoleLimb& leg = roles.limbs[i];
    CHECK(leg.nodes.size() == 3);
    const double side = where[leg.nodes[0]].x();
    for (const int n : leg.nodes) CHECK(where[n].x() * side > 0);
  }
}

TEST_CASE("without names, shape gives a human and a fox the roles their names give them") {
  for (const auto& [tree, body] : {std::pair{kMixamo, Body::kHuman}, std::pair{kFox, Body::kFox}}) {
    const NamedRig rig = named_rig(tree, body);
    const Roles named = roles_of(rig), unnamed = roles_of(nameless(rig));
    CHECK(unnamed.kind == named.kind);
    REQUIRE(unnamed.limbs.size() == named.limbs.size());
    for (std::size_t i = 0; i < named.limbs.size(); ++i) {
      CHECK(unnamed.limbs[i].name == named.limbs[i].name);
      CHECK(unnamed.limbs[i].nodes.front() == named.limbs[i].nodes.front());
      CHECK(unnamed.limbs[i].extremity == named.limbs[i].extremity);
      CHECK(unnamed.limbs[i].girdle == named.limbs[i].girdle);
    }
    CHECK(unnamed.trunk.front() == named.trunk.front());
    CHECK(unnamed.neck_head.back() == named.neck_head.back());
  }
}

TEST_CASE("arms and legs are told apart whichever of them the rig's root is nearer to") {
  const NamedRig rig = nameless(named_rig(R"(
Chest = chest
  Neck = neck
    Head = head
  L_Arm1 = left_shoulder
    L_Arm2 = left_elbow
      L_Arm3 = left_wrist
  R_Arm1 = right_shoulder
    R_Arm2 = right_elbow
      R_Arm3 = right_wrist
  Spine = spine
    Pelvis = pelvis
      L_Leg1 = left_hip
        L_Leg2 = left_knee
          L_Leg3 = left_ankle
            L_Leg4 = left_toe
      R_Leg1 = right_hip
        R_Leg2 = right_knee
          R_Leg3 = right_ankle
            R_Leg4 = right_toe
)"));
  const Roles roles = roles_of(rig);
  CHECK(roles.kind == BodyKind::kBiped);
  for (std::size_t n = 0; n < rig.expected.size(); ++n) {
    CAPTURE(n);
    CHECK(roles.of_node[n].role == rig.expected[n]);
  }
}

TEST_CASE("a snake is its longest chain, with no limbs") {
  NamedRig snake;
  for (int i = 0; i < 12; ++i) {
    Node node;
    node.name = "bone_" + std::to_string(i);
    node.parent = i - 1;
    node.local.translation() = Vec3(0, 0, i == 0 ? 0 : 0.3);
    snake.rig.nodes.push_back(node);
  }
  const Roles roles = roles_of(snake);
  CHECK(roles.kind == BodyKind::kOther);
  CHECK(roles.limbs.empty());
  REQUIRE(roles.trunk.size() == 12);
  CHECK(roles.trunk.front() == 0);
  CHECK(roles.trunk.back() == 11);
}

TEST_CASE("rigs that are hardly one have no roles, and no rig has none at all") {
  CHECK(find_roles({}, {}).kind == BodyKind::kUnknown);
  CHECK(find_roles({}, {}).of_node.empty());
  SourceRig one;
  one.nodes.emplace_back();
  const Roles roles = find_roles(one, {});
  CHECK(roles.kind == BodyKind::kUnknown);
  CHECK(roles.of_node[0].role == "other");
  // All nodes in one place: nothing to divide by.
  SourceRig point;
  for (const char* name : {"Hips", "LeftArm", "RightArm", "LeftUpLeg", "RightUpLeg", "Head"}) {
    Node node;
    node.name = name;
    node.parent = point.nodes.empty() ? -1 : 0;
    point.nodes.push_back(node);
  }
  CHECK(find_roles(point, {}).limbs.size() == 4);
  for (Node& node : point.nodes) node.name.clear();
  CHECK(find_roles(point, {}).limbs.empty());
  // A bone whose matrix cannot be inverted falls back on its node.
  NamedRig flat = named_rig(kMixamo);
  flat.rig.bones[3].inverse_bind.linear().setZero();
  check_roles(flat);
  for (const Vec3& position : rest_positions(flat.rig)) CHECK(position.allFinite());
}

TEST_CASE("roles do not depend on place, size, orientation and order") {
  for (const auto& [tree, body] : {std::pair{kMixamo, Body::kHuman}, std::pair{kFox, Body::kFox}}) {
    for (const NamedRig& rig : {named_rig(tree, body), nameless(named_rig(tree, body))}) {
      const std::vector<std::string> expected = summary(rig);
      CHECK(summary(moved(rig)) == expected);
      for (const unsigned seed : {1U, 2U, 3U}) CHECK(summary(shuffled(rig, seed)) == expected);
    }
  }
  const NamedRig capture = named_rig(kCapture);
  CHECK(summary(moved(capture)) == summary(capture));
  CHECK(rest_positions(moved(capture).rig)[0].isApprox(moved(rest_positions(capture.rig)[0]), 1e-9));
  for (const bool named : {true, false}) {
    const NamedRig six_legs = insect(3, named);
    CHECK(summary(moved(six_legs)) == summary(six_legs));
    for (const unsigned seed : {1U, 2U, 3U}) CHECK(summary(shuffled(six_legs, seed)) == summary(six_legs));
  }
}

TEST_CASE("names decide left and right; where feet contradict them, the reason says so") {
  NamedRig rig = named_rig(kMixamo);
  for (Vec3& p : rig.positions) p.z() = -p.z();
  for (Bone& bone : rig.rig.bones) bone.inverse_bind.translation().z() *= -1;
  const Roles roles = roles_of(rig);
  const NodeRole& hip = roles.of_node[limb(roles, "left_leg").nodes[0]];
  CHECK(rig.rig.nodes[limb(roles, "left_leg").nodes[0]].name == "mixamorig:LeftUpLeg");
  CHECK(hip.reason.find("though it is on the other one") != std::string::npos);
  const Roles right = roles_of(named_rig(kMixamo));
  for (const NodeRole& role : right.of_node) CHECK(role.reason.find("though") == std::string::npos);
}

TEST_CASE("a role file goes before names and shape") {
  const NamedRig rig = named_rig(kMixamo);
  const RoleFile file = parse_role_file(
      R"({"mixamorig:LeftArm": "left_clavicle", "mixamorig:LeftForeArm": "left_shoulder",
          "mixamorig:LeftHand": "left_elbow", "mixamorig:LeftHandIndex1": "left_wrist", "mixamorig:HeadTop_End": "jaw"})",
      "roles.json");
  const Roles roles = find_roles(rig.rig, rig.positions, file);
  const RoleLimb& arm = limb(roles, "left_arm");
  CHECK(rig.rig.nodes[arm.nodes.front()].name == "mixamorig:LeftForeArm");
  CHECK(rig.rig.nodes[arm.nodes[arm.extremity]].name == "mixamorig:LeftHandIndex1");
  for (const auto& [name, role] : file.role_of) {
    for (std::size_t n = 0; n < rig.rig.nodes.size(); ++n) {
      if (rig.rig.nodes[n].name == name) CHECK(roles.of_node[n].role == role);
    }
  }
  CHECK(limb(roles, "right_arm").nodes.front() == limb(roles_of(rig), "right_arm").nodes.front());
}

TEST_CASE("a broken role file is refused by name") {
  const auto message = [](const std::string& text) {
    try {
      const NamedRig rig = named_rig(kMixamo);
      find_roles(rig.rig, rig.positions, parse_role_file(text, "roles.json"));
    } catch (const Error& e) {
      CHECK(e.code() == ExitCode::kFile);
      return std::string(e.what());
    }
    return std::string();
  };
  CHECK(message("{").find("roles.json: is not a JSON object") == 0);
  CHECK(message("[]").find("roles.json: is not a JSON object") == 0);
  CHECK(message(R"({"mixamorig:Head": 3})").find("roles.json: the role of node 'mixamorig:Head'") == 0);
  CHECK(message(R"({"mixamorig:Head": "brain"})").find("roles.json: unknown role 'brain'") == 0);
  CHECK(message(R"({"mixamorig:Head": "left_head"})").find("roles.json: unknown role 'left_head'") == 0);
  CHECK(message(R"({"Head": "head"})").find("roles.json: the rig has no node 'Head'") == 0);
  CHECK(message(R"({"mixamorig:Head": "head"})").empty());
}
