// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "play/play.h"
#include "spherechain/skin_contacts.h"

namespace spherechain::baker {

// An asset's skin for contacts that leave out nothing but neighbours on the mesh: what intersects at rest counts, too.
class WholeSkin {
 public:
  // The asset must have clusters, and outlive this.
  explicit WholeSkin(const OpenAsset& asset);
  const std::uint64_t* table() const { return table_.data(); }

 private:
  std::vector<std::uint64_t> table_;
};

// Which body parts' skins intersect in one pose after another, exactly; of any spheres, ignored or not. One thread's.
class TouchingParts {
 public:
  // All must outlive this.
  TouchingParts(const AnimatedAsset& animated, const WholeSkin& skin, Target target);

  // Holds until the next call. Parts that meet themselves are among them.
  const std::vector<PartContact>& find(const Deformation& deformation);

 private:
  const AnimatedAsset& animated_;
  const WholeSkin& skin_;
  Target target_;
  std::vector<std::uint64_t> scratch_;
  std::vector<PartContact> contacts_;
};

}  // namespace spherechain::baker
