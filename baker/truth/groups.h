// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/play/asset_file.h"
#include "baker/truth/truth.h"

namespace spherechain::baker {

// Counts for a group of pairs: true pairs, true pairs that were found, reported pairs.
struct PairGroup {
  std::string name;
  std::size_t true_pairs = 0, found_pairs = 0;  // triangle pairs
  std::size_t reported = 0;                     // sphere pairs
};

// Two regions: "left_arm - torso", every pair of them, in the asset's order.
class RegionGroups {
 public:
  explicit RegionGroups(const OpenAsset& asset);
  void add(const FrameTruth& truth, const std::vector<Pair>& reported);
  const std::vector<PairGroup>& groups() const { return groups_; }

 private:
  PairGroup& of(const Pair& pair);

  std::vector<std::size_t> region_of_;
  std::size_t regions_;
  std::vector<PairGroup> groups_;
};

}  // namespace spherechain::baker
