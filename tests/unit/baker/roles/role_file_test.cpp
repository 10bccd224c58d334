// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include "baker/mesh/error.h"
#include "role_cases.h"

using namespace spherechain::baker;

TEST_CASE("a role file goes before names and shape") {
  const NamedRig rig = named_rig(kMixamo);
  const RoleFile file = parse_role_file(
      R"({"mixamorig:LeftArm": "left_clavicle", "mixamorig:LeftForeArm": "left_shoulder",
          "mixamorig:LeftHand": "left_elbow", "mixamorig:LeftHandIndex1": "left_wrist", "mixamorig:HeadTop_End": "jaw"})",
      "roles.json");
  const Roles roles = find_roles(rig.rig, rig.positions, file);
  const RoleLimb& arm = limb_called(roles, "left_arm");
  CHECK(rig.rig.nodes[arm.nodes.front()].name == "mixamorig:LeftForeArm");
  CHECK(rig.rig.nodes[arm.nodes[arm.extremity]].name == "mixamorig:LeftHandIndex1");
  for (const auto& [name, role] : file.role_of) {
    for (std::size_t n = 0; n < rig.rig.nodes.size(); ++n) {
      if (rig.rig.nodes[n].name == name) CHECK(roles.of_node[n].role == role);
    }
  }
  CHECK(limb_called(roles, "right_arm").nodes.front() == limb_called(roles_of(rig), "right_arm").nodes.front());
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
