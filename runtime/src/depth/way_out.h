// SPDX-License-Identifier: MIT
// The shortest of the ways out along a few directions that are likely to be short.
#pragma once

#include "depth/sweep.h"

namespace spherechain {

struct Exit {
  Double3 direction{0, 0, 1};
  WayOut way;
};

struct ExitSettings {
  bool one_direction = false;
  double near = 0;                    // ways are likely to be shorter
  double deep = 0;                    // above it many more directions are tried
  bool are_joined = false;            // one part goes on in the other: neither can lie inside the other whole
  const Double3* previous = nullptr;  // the last frame's, or null
};

// Three directions at right angles that turn with the contour; the first is the one given.
void axes_of(const Contour& contour, const Double3& direction, Double3 (&axes)[3]);

// The sweep's sides are set.
Exit find_exit(Sweep& sweep, const Contour& contour, const ExitSettings& settings);

}  // namespace spherechain
