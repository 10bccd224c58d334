// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include "role_cases.h"

using namespace spherechain::baker;

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
  CHECK(names_of(rig, roles.limbs[4].nodes) == Names{"b_Tail01_012", "b_Tail02_013", "b_Tail03_014"});
  CHECK(names_of(rig, roles.trunk) == Names{"b_Hip_01", "b_Spine01_02", "b_Spine02_03"});
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
  CHECK(names_of(rig, roles.trunk) == Names{"Pelvis", "Spine_Back01", "Root", "Spine_Front01"});
}

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
      CHECK(names_of(rig, roles.limbs[2 * p].nodes) ==
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
