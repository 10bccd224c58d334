// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <set>
#include <string>
#include <vector>

#include "baker/volumes/colliders.h"

namespace spherechain::baker {

// The name with each character that `is_allowed` refuses replaced by an underscore.
std::string with_allowed(std::string name, bool (*is_allowed)(char));

// The bodies' names, so, made unique by numbers; none is one of `taken`.
std::vector<std::string> unique_names(const Colliders& colliders, bool (*is_allowed)(char),
                                      std::set<std::string> taken = {});

}  // namespace spherechain::baker
