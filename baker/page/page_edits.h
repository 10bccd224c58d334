// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "baker/page/from_runtime.h"
#include "baker/play/play.h"

namespace spherechain::baker {

// Data for the page's editor: each region's own coordinates, and the edits that the bake applied.
nlohmann::ordered_json page_edits(const AnimatedAsset& animated, const std::vector<PageSphere>& spheres);

}  // namespace spherechain::baker
