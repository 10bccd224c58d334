// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/mesh/polyline.h"
#include "baker/segment/curve_skeleton.h"

namespace spherechain::baker {

// The long branches of a skeleton as a tree, without the short ones (fingers, toes, ears, noise).
struct BranchTree {
  struct Branch {
    Index from, to;  // junction (or tip) at either end
    Polyline line;   // from `from` to `to`
  };
  std::vector<Branch> branches;
  std::vector<std::vector<Index>>
      at;  // a node -> the branches that end there: one at a tip, three or more at a junction

  bool is_tip(Index node) const { return at[node].size() == 1; }
  std::size_t tip_count() const;
};

// Keeps the branches that are at least `shortest` of the tree's longest path.
BranchTree find_long_branches(const CurveSkeleton& skeleton, double shortest);

}  // namespace spherechain::baker
