// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mesh/mesh.h"

namespace spherechain::baker {

// A closed surface around triangles in any state (CGAL's alpha wrap): what a ball of radius `alpha` cannot reach from
// outside is inside, and the surface lies `offset` away from the triangles. Lengths in the mesh's units, both above 0.
// Nested or separate surfaces are possible; each is closed and consistently oriented outwards. The result does not
// depend on the order of the vertices and triangles, and turns, moves and scales with the mesh.
Mesh alpha_wrap(const Mesh& mesh, double alpha, double offset);

}  // namespace spherechain::baker
