// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/bind/bind.h"
#include "baker/bind/body_parts.h"

namespace spherechain::baker {

// Contacts between neighbours are left out, and an edited sphere has other neighbours. A line for each two body parts
// that lose contacts so: how much of all pairs of places on their skins is left out before and after.
std::vector<std::string> hidden_contacts(const Character& character, const BodyParts& parts, const Binding& before,
                                         const Binding& after);

}  // namespace spherechain::baker
