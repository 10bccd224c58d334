// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/layers/skin.h"

namespace spherechain::baker {

struct RestView {
  std::vector<double> seen;       // of each triangle: its area in the picture by its area, mean over the views
  std::vector<char> is_inverted;  // pieces that are seen from behind more than from the front
};

// Looks at a skin at rest from all views, `turns` times. `pixel`: the size of a pixel, a share of the height.
RestView look_at_rest(const LayeredSkin& skin, std::size_t turns, double pixel);

}  // namespace spherechain::baker
