// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "mesh/mesh.h"

namespace spherechain::baker {

using SpherePairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;  // a < b

// Adds the pairs whose surrounding regions are neighbours on a mesh: triangles of theirs share an edge, or the way from
// the one to the other along the mesh's edges is shorter than `gap`. On even triangles such a way is at most 15 %
// longer than the geodesic.
void add_neighbours(const Mesh& mesh, const std::vector<std::uint32_t>& owner, double gap, SpherePairs& pairs);

}  // namespace spherechain::baker
