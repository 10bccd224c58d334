// SPDX-License-Identifier: GPL-3.0-or-later
// The plain interface to CGAL's exact predicates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <vector>

#include "truth/surface.h"

namespace spherechain::baker {

struct Intersections {
  std::vector<Pair> pairs;     // sorted
  std::size_t degenerate = 0;  // triangles without area, which intersect nothing
};

// Every pair of a surface's triangles that have a point in common, neighbours left out: decided exactly for the
// positions (x, y, z of each source vertex) as they are; touching and lying in one plane count. May run in several
// threads.
Intersections find_intersections(const TruthSurface& surface, const std::vector<float>& positions);

// Every pair of a triangle of one body and a triangle of another that have a point in common: as source triangles, a's
// first.
std::vector<Pair> find_intersections(const TruthSurface& a, const std::vector<float>& positions_a,
                                     const TruthSurface& b, const std::vector<float>& positions_b);

// True if a triangle of the one list (places in the surface) is closer than `distance` to one of the other.
bool any_closer(const TruthSurface& surface, const std::vector<float>& positions, const std::vector<Index>& one,
                const std::vector<Index>& other, double distance);

// Which owners have triangles closer to each other than `distance`: a < b. `owner`: a place in the surface -> its
// owner.
std::set<Pair> close_owners(const TruthSurface& surface, const std::vector<float>& positions,
                            const std::vector<std::uint32_t>& owner, double distance);

}  // namespace spherechain::baker
