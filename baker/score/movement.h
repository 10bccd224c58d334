// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// Places of one or more points, frame by frame.
using Track = std::vector<std::vector<Vec3>>;

// The mean length of the n-th difference over time (2: acceleration, 3: jerk), over all points and the frames that have
// one, in lengths per second to the n. 0 where no frame has one.
double mean_difference(const Track& track, int order, double fps);
// The mean distance of the points of two tracks, over the frames that both have.
double mean_distance(const Track& a, const Track& b);

}  // namespace spherechain::baker
