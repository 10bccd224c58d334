// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/import/import.h"
#include "baker/motion/motion.h"
#include "baker/play/asset_file.h"
#include "spherechain/contacts.h"
#include "spherechain/types.h"

namespace spherechain::baker {

// The triangle pairs the runtime's narrow phase finds in deformed source vertices (x, y, z after another); sorted. The
// asset must have leaves.
std::vector<Pair> find_contacts(const OpenAsset& asset, const std::vector<float>& positions, Scope scope,
                                Target target);

// The same from the matrices of bones and the morphs' weights alone, for an asset that bones move.
struct ContactsFromBones {
  std::vector<float> positions;  // the runtime's positions of the source vertices, which its results are based on
  std::vector<Pair> pairs, neighbours;  // of the two scopes; sorted
};
ContactsFromBones find_contacts_from_bones(const OpenAsset& asset, const Character& character,
                                           const Deformation& deformation, Target target);

// Differences of two sorted lists.
struct ContactErrors {
  std::size_t missing = 0;  // true, not found
  std::size_t extra = 0;    // found, not true
};
ContactErrors compare(const std::vector<Pair>& found, const std::vector<Pair>& truth);

}  // namespace spherechain::baker
