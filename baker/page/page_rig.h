// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "baker/play/play.h"

namespace spherechain::baker {

// Data for posing the character by hand. Null if the bones of the asset do not move it.
nlohmann::ordered_json page_rig(const AnimatedAsset& animated);

}  // namespace spherechain::baker
