// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "import/import.h"
#include "motion/motion.h"
#include "spherechain/asset.h"
#include "spherechain/simd.h"
#include "spherechain/surface.h"
#include "spherechain/triangle_contacts.h"

namespace spherechain::baker {

// The triangle pairs the runtime's narrow phase finds in deformed source vertices (x, y, z after another); sorted. The
// asset must have leaves.
std::vector<TrianglePair> find_contacts(const Asset& asset, const std::vector<float>& positions, ContactScope scope,
                                        Target target);

// The same from the matrices of bones and the morphs' weights alone, for an asset that bones move.
struct ContactsFromBones {
  std::vector<float> positions;                 // where the runtime has the source vertices: what it decided on
  std::vector<TrianglePair> pairs, neighbours;  // of the two scopes; sorted
};
ContactsFromBones find_contacts_from_bones(const Asset& asset, const Character& character,
                                           const Deformation& deformation, Target target);

// What two sorted lists do not have in common.
struct ContactErrors {
  std::size_t missing = 0;  // true, not found
  std::size_t extra = 0;    // found, not true
};
ContactErrors compare(const std::vector<TrianglePair>& found, const std::vector<TrianglePair>& truth);

}  // namespace spherechain::baker
