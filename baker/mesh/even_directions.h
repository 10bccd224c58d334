// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// Unit vectors, evenly spread over the sphere (a Fibonacci lattice).
std::vector<Vec3> even_directions(int count);

}  // namespace spherechain::baker
