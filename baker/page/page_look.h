// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "baker/import/look.h"

namespace spherechain::baker {

// The page's `look`: the skin's base colours, pictures scaled down. Null where it has none, or one colour alone.
nlohmann::ordered_json page_look(const SourceLook& look);

}  // namespace spherechain::baker
