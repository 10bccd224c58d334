// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace spherechain::baker {

// How deep objects and lists are in one another, in a text that need not be JSON. (nlohmann's parser can count too, but
// then takes quadratic time.)
int json_depth(std::string_view text);

}  // namespace spherechain::baker
