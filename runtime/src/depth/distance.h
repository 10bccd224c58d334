// SPDX-License-Identifier: MIT
#pragma once

#include "depth/posed_skin.h"

namespace spherechain {

// Of two triangles that do not cross: of all corners to the other triangle, and of all edges to the other's.
double distance_of(const Corners& a, const Corners& b);

}  // namespace spherechain
