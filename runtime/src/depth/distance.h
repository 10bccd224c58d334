// SPDX-License-Identifier: MIT
#pragma once

#include "runtime/src/depth/posed_skin.h"

namespace spherechain {

// The nearest points of two triangles that do not cross: of all corners and the other triangle, and of all pairs of
// edges.
struct Nearest {
  double distance;
  Double3 a, b;
};
Nearest nearest_of(const Corners& a, const Corners& b);
inline double distance_of(const Corners& a, const Corners& b) { return nearest_of(a, b).distance; }

}  // namespace spherechain
