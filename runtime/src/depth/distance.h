// SPDX-License-Identifier: MIT
#pragma once

#include "depth/posed_skin.h"

namespace spherechain {

// The distance of two triangles that do not cross: the least of all corners to the other triangle, and of all edges to
// the other's.
double distance_of(const Corners& a, const Corners& b);

}  // namespace spherechain
