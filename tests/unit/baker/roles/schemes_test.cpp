// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include "role_cases.h"

using namespace spherechain::baker;

namespace {

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

}  // namespace

TEST_CASE("roles of a Mixamo rig: LeftArm is the upper arm, LeftShoulder the clavicle, LeftLeg the shin") {
  const NamedRig rig = named_rig(kMixamo);
  check_roles(rig);
  const Roles roles = roles_of(rig);
  CHECK(names_of(rig, roles.trunk) ==
        Names{"mixamorig:Hips", "mixamorig:Spine", "mixamorig:Spine1", "mixamorig:Spine2"});
  CHECK(names_of(rig, roles.neck_head) == Names{"mixamorig:Neck", "mixamorig:Head"});
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
  CHECK(rig.rig.nodes[limb_called(roles, "left_leg").girdle].name == "pelvis.L");
  CHECK(rig.rig.nodes[limb_called(roles, "left_arm").girdle].name == "clavicle.L");
}

TEST_CASE("roles of a CMU capture: hip joints are no thighs") {
  const NamedRig rig = named_rig(kCapture);
  check_roles(rig);
  const Roles roles = roles_of(rig);
  CHECK(rig.rig.nodes[limb_called(roles, "left_leg").girdle].name == "LHipJoint");
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

TEST_CASE("roles of a Rigify rig: deform bones, not controls") { check_roles(named_rig(kRigify)); }

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
                    1H_Axe = !attachment
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
