// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

using SpherePairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;  // a < b

// Adds the pairs of spheres that are neighbours on a mesh: their triangles share an edge, or a path along the mesh's
// edges from one to the other is shorter than `gap`. On even triangles such a path is at most 15 % longer than the
// geodesic. `owner`: a triangle -> its sphere.
void add_neighbours(const Mesh& mesh, const std::vector<std::uint32_t>& owner, double gap, SpherePairs& pairs);

}  // namespace spherechain::baker
