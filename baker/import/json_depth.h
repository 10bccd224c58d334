// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

namespace spherechain::baker {

// How deeply objects and lists are nested in a text, which need not be JSON. (nlohmann's parser can count, too, but
// takes quadratic time then.)
int json_depth(std::string_view text);

}  // namespace spherechain::baker
