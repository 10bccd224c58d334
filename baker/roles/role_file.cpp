// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "baker/mesh/error.h"
#include "baker/roles/names.h"
#include "baker/roles/roles.h"

namespace spherechain::baker {

RoleFile parse_role_file(const std::string& text, const std::string& file) {
  const auto fail = [&](const std::string& what) { throw Error(ExitCode::kFile, file + ": " + what); };
  RoleFile roles{file, {}};
  const nlohmann::json object = nlohmann::json::parse(text, nullptr, false);
  if (!object.is_object()) fail("is not a JSON object (give each node's name its role)");
  for (const auto& [node, role] : object.items()) {
    if (!role.is_string()) fail("the role of node '" + node + "' is not a text");
    if (hint_of_role(role.get<std::string>()).word == Word::kNone) {
      fail("unknown role '" + role.get<std::string>() + "' of node '" + node +
           "' (known: root, pelvis, spine, chest, neck, head, tail, eye, jaw, hair, head_part, attachment, control, "
           "other, and with left_ or right_: clavicle, shoulder, elbow, wrist, finger, hip, knee, ankle, toe)");
    }
    roles.role_of[node] = role.get<std::string>();
  }
  return roles;
}

}  // namespace spherechain::baker
