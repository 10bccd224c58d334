// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "baker/play/play.h"

namespace spherechain::baker {

// The axes the page shows a character in. A body that is no biped may have its spine for `up`, as a fox has: it stands
// on the ground as its file has it. A biped stands on its feet, whatever its file says.
BodyFrame page_axes(const AnimatedAsset& animated);

nlohmann::ordered_json axes_json(const BodyFrame& frame);

}  // namespace spherechain::baker
