// SPDX-License-Identifier: GPL-3.0-or-later
// The plain interface to CGAL's exact predicates.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "baker/truth/surface.h"

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

// Tells whether two owners' triangles are closer than `distance`, and remembers each answer. `surface` and `positions`
// must outlive it.
class Closeness {
 public:
  Closeness(const TruthSurface& surface, const std::vector<float>& positions, double distance)
      : surface_(surface), positions_(positions), distance_(distance) {}

  bool operator()(const Pair& pair) {
    const auto [entry, is_new] = known_.try_emplace(pair, false);
    if (is_new) {
      entry->second =
          any_closer(surface_, positions_, surface_.of_sphere[pair.a], surface_.of_sphere[pair.b], distance_);
    }
    return entry->second;
  }

 private:
  const TruthSurface& surface_;
  const std::vector<float>& positions_;
  double distance_;
  std::map<Pair, bool> known_;
};

// Which owners have triangles closer to each other than `distance`: a < b. `owner`: a place in the surface -> its
// owner.
std::set<Pair> close_owners(const TruthSurface& surface, const std::vector<float>& positions,
                            const std::vector<std::uint32_t>& owner, double distance);

}  // namespace spherechain::baker
