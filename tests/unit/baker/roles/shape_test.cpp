// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>

#include "role_cases.h"

using namespace spherechain::baker;

TEST_CASE("without names, shape gives a human and a fox the roles their names give them") {
  for (const auto& [tree, body] : {std::pair{kMixamo, Body::kHuman}, std::pair{kFox, Body::kFox}}) {
    const NamedRig rig = named_rig(tree, body);
    const Roles named = roles_of(rig), unnamed = roles_of(nameless(rig));
    CHECK(unnamed.kind == named.kind);
    CHECK(limbs_by_shape(named).empty());
    CHECK(limbs_by_shape(unnamed).size() >= 4);
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

TEST_CASE("arms and legs are recognised whichever of them the rig's root is nearer to") {
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
      const std::vector<std::string> expected = summary_of(rig);
      CHECK(summary_of(moved(rig)) == expected);
      for (const unsigned seed : {1U, 2U, 3U}) CHECK(summary_of(shuffled(rig, seed)) == expected);
    }
  }
  const NamedRig capture = named_rig(kCapture);
  CHECK(summary_of(moved(capture)) == summary_of(capture));
  CHECK(rest_positions(moved(capture).rig)[0].isApprox(moved(rest_positions(capture.rig)[0]), 1e-9));
  for (const bool named : {true, false}) {
    const NamedRig six_legs = insect(3, named);
    CHECK(summary_of(moved(six_legs)) == summary_of(six_legs));
    for (const unsigned seed : {1U, 2U, 3U}) CHECK(summary_of(shuffled(six_legs, seed)) == summary_of(six_legs));
  }
}

TEST_CASE("nodes without skin above joints, and twins in joints' places, leave the joints' roles as they are") {
  for (const auto& [tree, body] : {std::pair{kMixamo, Body::kHuman}, std::pair{kFox, Body::kFox}}) {
    const NamedRig named = named_rig(tree, body);
    NamedRig unnamed = nameless(named);
    const Roles by_shape = roles_of(unnamed);
    for (std::size_t n = 0; n < by_shape.of_node.size(); ++n) unnamed.expected[n] = by_shape.of_node[n].role;
    const Vec3 away(0.02, -0.04, 0.03), here = Vec3::Zero();
    const NamedRig rigs[] = {with_offsets(named, away),
                             with_offsets(with_offsets(named, away), here),
                             with_offsets(unnamed, away),
                             nameless(with_offsets(unnamed, here)),
                             with_twins(named),
                             nameless(with_twins(unnamed)),
                             nameless(with_twins(with_offsets(unnamed, here)))};
    for (const NamedRig& rig : rigs) {
      CAPTURE(&rig - rigs);
      const Roles roles = roles_of(rig);
      for (std::size_t n = 0; n < rig.expected.size(); ++n) {
        const std::string& role = roles.of_node[n].role;
        CAPTURE(rig.rig.nodes[n].name);
        if (rig.expected[n].empty())
          CHECK((role == "twist" || role == "head_part" || role == "other" || role == "root"));
        else
          CHECK(role == rig.expected[n]);
      }
      CHECK(summary_of(shuffled(rig, 1)) == summary_of(rig));
    }
  }
}

TEST_CASE("a leaf in a joint's place has the role that its own name tells") {
  NamedRig rig = with_twins(named_rig(kMixamo));
  const auto leaf = std::find_if(rig.rig.nodes.begin(), rig.rig.nodes.end(),
                                 [](const Node& node) { return node.name == "mixamorig:Head_b"; });
  REQUIRE(leaf != rig.rig.nodes.end());
  leaf->name = "Jaw";
  CHECK(roles_of(rig).of_node[static_cast<std::size_t>(leaf - rig.rig.nodes.begin())].role == "jaw");
}

TEST_CASE("a joint without skin keeps its role where the next one down is another joint") {
  check_roles(named_rig(R"(
Hips = pelvis
  Spine = !spine
    Spine1 = spine
      Spine2 = chest
        Neck = !neck
          Head = head
        LeftShoulder = !left_clavicle
          LeftArm = !left_shoulder
            LeftForeArm = left_elbow
              LeftHand = !left_wrist
                LeftHandIndex1 = left_finger
        RightShoulder = !right_clavicle
          RightArm = !right_shoulder
            RightForeArm = right_elbow
              RightHand = !right_wrist
                RightHandIndex1 = right_finger
  LeftUpLeg = left_hip
    LeftLeg = left_knee
      LeftFoot = !left_ankle
        LeftFoot_end = left_toe
  RightUpLeg = right_hip
    RightLeg = right_knee
      RightFoot = !right_ankle
        RightFoot_end = right_toe
)"));
}
