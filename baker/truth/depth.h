// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "truth/truth.h"

namespace spherechain::baker {

// How deep two spheres' triangles are in each other, in the mesh's units: the farthest that a vertex of the
// one lies behind the other, measured to the nearest point of the other. Vertices whose nearest point is on the other
// region's border are left out, for there a region has no behind. At least, over the contact's triangle pairs, how far
// one must move along the other's normal, or the other along its, to lie on one side of it.
double penetration(const TrueContact& contact, const TruthSurface& surface, const std::vector<float>& positions);

}  // namespace spherechain::baker
