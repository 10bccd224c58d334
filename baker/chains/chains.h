// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "baker/fit/fit.h"

namespace spherechain::baker {

struct Chain {
  std::string name;                    // zeta0 ..
  std::vector<std::uint8_t> regions;   // limb, torso, limb; of a tree: from leaf to leaf
  std::vector<std::uint32_t> spheres;  // each once: from one limb's tip through the torso to the other limb's tip
};

struct Chains {
  std::vector<Chain> chains;
  // As the paper counts: spheres that are in two parts of a chain count twice. For a biped that is
  // 3x + 2(|L| + |R|) + 3|T| + |D|, and 5 for each sphere of the head, of which the paper has none.
  std::size_t entries_table1 = 0;

  std::size_t entries() const;
};

// The place at which a limb leaves the torso.
struct LimbPlace {
  std::uint8_t region;
  Side side;     // none: in the plane of symmetry; it counts for either side
  double along;  // from 0, the hip, to 1, the chest
};

// The rule behind the paper's Table 1, for any number of limbs: one chain for each pair of limbs, through the part of
// the torso between them. That part is
// - for limbs at the same place along the torso: the level there (T, D),
// - for limbs on one side: that side between them (L, R),
// - for all others: the upper limb's level, then the lower limb's side.
// Chains come in the order sides, ends, diagonals. A sphere in the middle of its level belongs to both sides. The head
// is in every chain that goes through the top level. A single limb is a chain of its own. The order of a chain's
// spheres is for readers; neighbours on the body are Spheres::links.
Chains build_chains(const Spheres& spheres, const std::vector<LimbPlace>& limbs);

// Builds chains for regions that form a tree (Regions::parents): one per two leaves, through the regions between them.
// A single leaf's chain goes to the root.
Chains build_tree_chains(const Spheres& spheres, const std::vector<std::uint8_t>& parents);

}  // namespace spherechain::baker
