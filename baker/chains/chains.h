// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fit/fit.h"

namespace spherechain::baker {

struct Chain {
  std::string name;                    // zeta0 ..
  std::vector<std::uint8_t> regions;   // limb, torso, limb
  std::vector<std::uint32_t> spheres;  // each once: from one limb's tip, the head, through the torso to the other's tip
};

struct Chains {
  std::vector<Chain> chains;
  // The paper's count, 3x + 2(|L| + |R|) + 3|T| + |D| for a biped, and 5 for each sphere of the head, which the paper
  // has none of: the same lists with the spheres that stand in two of a chain's parts counted twice.
  std::size_t entries_table1 = 0;

  std::size_t entries() const;
};

// The rule behind the paper's Table 1, for any number of limbs: a chain for each pair of limbs, through the part of the
// torso between them. Limbs at one place of the torso (T, D) are joined by the level there; limbs on one side by that
// side between them (L, R); the others by the upper limb's level and then the lower limb's side. First the sides, then
// the ends, then the diagonals. A sphere in the middle of its level is both sides'. The head hangs on the top level: it
// is in every chain that goes there. A list's order is for reading: what stands next to each other on the body is
// Spheres::links. A single limb is a chain of its own.
struct LimbPlace {
  std::uint8_t region;
  Side side;     // none: in the plane of symmetry, on either side's way
  double along;  // where it leaves the torso, from 0, the hip, to 1, the chest
};
Chains build_chains(const Spheres& spheres, const std::vector<LimbPlace>& limbs);

}  // namespace spherechain::baker
