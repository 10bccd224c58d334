// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "character.h"
#include "pair_finder.h"

namespace spherechain::bench {

struct Agreement {
  std::size_t pairs = 0;       // over all poses, as the runtime reports them
  std::size_t candidates = 0;  // what the finder found, before the runtime's rule left some out
  std::size_t ties = 0;        // pairs that touch by the one arithmetic and not by the other: to 1e-5 of their distance
  std::string difference;      // empty: the sets are equal
};

// Over all poses: the pairs that `finder` found and the runtime's rule reports, against the plain loop over all pairs.
// A finder of spheres that touch must also find none that do not.
Agreement check_pairs(const PosedCharacter& character, PairFinder& finder);

}  // namespace spherechain::bench
