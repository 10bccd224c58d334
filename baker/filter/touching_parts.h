// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "play/play.h"
#include "spherechain/skin_contacts.h"

namespace spherechain::baker {

// The body parts of each sphere's triangles, ascending.
std::vector<std::vector<std::uint8_t>> parts_of_spheres(const OpenAsset& asset);

// What of an asset's skin can tell which body parts meet; of that nothing is left out but neighbours on the mesh: what
// intersects at rest counts, and so do folds between two parts.
struct PartSkin {
  // The asset must have clusters.
  explicit PartSkin(const OpenAsset& asset);

  std::vector<std::uint64_t> table;     // the runtime's, without rest contacts
  std::vector<Pair> pairs;              // of spheres that have two parts between them
  std::vector<std::uint64_t> one_part;  // a bit for each sphere that has no two parts itself
  std::vector<std::uint64_t> none;      // no bit for any pair
  bool any_of_two = false;              // whether a sphere has two parts itself
};

// Which body parts' skins intersect in one pose after another: exactly. For one thread.
class TouchingParts {
 public:
  // Both must outlive this.
  TouchingParts(const AnimatedAsset& animated, const PartSkin& skin, Target target);

  // Holds until the next call; two parts may be there twice, and parts that meet themselves are there by chance.
  const std::vector<PartContact>& find(const Deformation& deformation);

 private:
  void add(SkinContactJob& job);

  const AnimatedAsset& animated_;
  const PartSkin& skin_;
  Target target_;
  std::vector<std::uint64_t> scratch_;
  std::vector<PartContact> contacts_;
};

}  // namespace spherechain::baker
