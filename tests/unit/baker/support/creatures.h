// SPDX-License-Identifier: GPL-3.0-or-later
// Closed meshes of creatures made of tapering tubes that melt into each other: bodies no file here has.
#pragma once

#include <vector>

#include "baker/import/import.h"

// A round cone from one ball to another.
struct Tube {
  spherechain::baker::Vec3 from, to;
  double from_radius, to_radius;
};

// The surface around the tubes' union, its corners rounded, as a closed mesh with edges about as long as `cell`.
spherechain::baker::SourceMesh melt(const std::vector<Tube>& tubes, double cell);

// y is up, z forward, x left. About 1.6 long.
std::vector<Tube> quadruped_tubes();
// Without head and tail.
std::vector<Tube> six_legged_tubes();
// A curved tube, 2.5 long, thicker at its head, which is at +z.
std::vector<Tube> snake_tubes();
