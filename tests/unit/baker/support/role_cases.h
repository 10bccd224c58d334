// SPDX-License-Identifier: GPL-3.0-or-later
// Rigs, and what the tests of roles check of them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "named_rig.h"

spherechain::baker::Roles roles_of(const NamedRig& rig);

// Each node has the role that the rig says, and a reason, which is not the rig's shape.
void check_roles(const NamedRig& rig, spherechain::baker::BodyKind kind = spherechain::baker::BodyKind::kBiped);

// REQUIREs that there is one.
const spherechain::baker::RoleLimb& limb_called(const spherechain::baker::Roles& roles, std::string_view name);

using Names = std::vector<std::string>;
Names names_of(const NamedRig& rig, const std::vector<int>& nodes);

// Facts that do not depend on a node's number: its name, role and limb's name.
Names summary_of(const NamedRig& rig);

// Trees for named_rig(): a human's by two schemes, a fox'.
extern const char* const kMixamo;
extern const char* const kCapture;
extern const char* const kFox;

// Legs by twos on one body, and a head.
NamedRig insect(int pairs, bool is_named);
