// SPDX-License-Identifier: MIT
#pragma once

#include "runtime/src/depth/posed_skin.h"

namespace spherechain {

// Distance of two triangles that do not cross: the least over all corners to the other triangle and all pairs of edges.
double distance_of(const Corners& a, const Corners& b);

}  // namespace spherechain
