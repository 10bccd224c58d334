// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// A closed surface around triangles in any state (CGAL's alpha wrap). All that a ball of radius `alpha` cannot reach
// from outside is inside; the surface lies `offset` away from the triangles. Both are in the mesh's units and above 0.
// There may be several surfaces, nested or apart; each is closed and faces outwards. There is none where all triangles
// are lines. The result does not depend on the order of vertices and triangles, and turns, moves and scales with the
// mesh.
Mesh alpha_wrap(const Mesh& mesh, double alpha, double offset);

}  // namespace spherechain::baker
