// SPDX-License-Identifier: MIT
// The shortest of the ways out along a few directions that are likely to be short.
#pragma once

#include "runtime/src/depth/sweep.h"

namespace spherechain {

struct Exit {
  Double3 direction{0, 0, 1};
  WayOut way;
};

struct ExitSettings {
  double deep = 0;          // above it many more directions are tried
  bool are_joined = false;  // one part goes on in the other: neither can lie inside the other whole
};

// Three directions at right angles that turn with the contour; the first is the one given.
void axes_of(const Contour& contour, const Double3& direction, Double3 (&axes)[3]);

// Along the one direction that the contour says. The sweep's sides are set; `near`: ways are likely to be shorter.
Exit first_exit(Sweep& sweep, const Contour& contour, double near);
// The shortest of many, `first` among them.
Exit shortest_exit(Sweep& sweep, const Contour& contour, const ExitSettings& settings, const Exit& first);
// In that direction, or near it, where it is nearly as good as the shortest, which was found last; else the shortest.
Exit steady_exit(Sweep& sweep, const Contour& contour, const ExitSettings& settings, const Exit& shortest,
                 const Double3& wanted);
// The shortest of many ways by which b parts from all of a. The sweep's gap must be larger than both parts.
Exit parting_exit(Sweep& sweep);

}  // namespace spherechain
