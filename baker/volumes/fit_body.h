// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/volumes/fit_one.h"

namespace spherechain::baker {

// Some volumes for one body, and how well they stand for its skin.
struct BodyFit {
  std::vector<Volume> volumes;
  double gap = 0;  // the sum over the samples of area times distance to the nearest surface, in or out: cubic metres
};

// `count` volumes, or fewer where there are fewer samples: the samples are cut into slabs along one of their axes, or
// into two rows of slabs; then each sample goes to the volume that is nearest to it, and each volume is fitted to its
// samples, some rounds of it. 90 % of the area is inside.
BodyFit fit_body(VolumeShape shape, const BodySkin& skin, int count);

}  // namespace spherechain::baker
