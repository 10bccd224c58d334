// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/import/source_rig.h"
#include "baker/roles/roles.h"
#include "baker/segment/segment.h"

namespace spherechain::baker {

// The everyday name of a body part, and the side it is on.
struct PartName {
  std::string name;
  Side side = Side::kNone;
  bool is_prop = false;    // BodyPart::is_prop
  bool inherited = false;  // from the node's ancestor
};

// The part that each node of a rig belongs to. A name is empty where neither the node nor any ancestor has a role.
std::vector<PartName> name_parts(const SourceRig& rig, const Roles& roles);

// The things that meshes are by their names: hair, a backpack, a sword. A name is empty where its mesh is no such
// thing: clothes lie around several parts of the body, and belong to them.
std::vector<PartName> name_meshes(const std::vector<std::string>& names);

// The part of a joint of the automatic rig.
PartName name_part(const std::string& joint);

// How mobile a body part of that name is (sc_part.mobility); -1 where the name does not say it.
int mobility_of(const std::string& part);

}  // namespace spherechain::baker
