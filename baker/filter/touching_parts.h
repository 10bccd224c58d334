// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/play/play.h"
#include "spherechain/contacts.h"

namespace spherechain::baker {

// The body parts of each sphere's triangles, ascending.
std::vector<std::vector<std::uint8_t>> parts_of_spheres(const OpenAsset& asset);

// The pairs of spheres whose triangles tell which body parts meet. Only neighbours on the mesh are left out: triangles
// that intersect at rest count, and so do folds between two parts.
struct PartSkin {
  // The asset must have clusters.
  explicit PartSkin(const OpenAsset& asset);

  std::vector<std::uint64_t> table;  // the runtime's, without rest contacts
  std::vector<Pair> pairs;           // of spheres, or of one with itself, that have two parts between them
};

// Which body parts' skins intersect in one pose after another: exactly. For one thread.
class TouchingParts {
 public:
  // Both must outlive this.
  TouchingParts(const AnimatedAsset& animated, const PartSkin& skin, Target target);

  // Holds until the next call. Parts that meet themselves are there by chance.
  const std::vector<PartContact>& find(const Deformation& deformation);

 private:
  const AnimatedAsset& animated_;
  const PartSkin& skin_;
  Target target_;
  std::vector<std::uint64_t> scratch_;
  std::vector<PartContact> contacts_;
};

}  // namespace spherechain::baker
