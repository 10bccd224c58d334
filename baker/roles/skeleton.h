// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "import/source_rig.h"

namespace spherechain::baker {

// A rig's nodes as a tree in the rest pose; parents come before their children.
struct Skeleton {
  std::vector<std::string> names;
  std::vector<int> parent;
  std::vector<std::vector<int>> children;
  std::vector<int> depth;  // steps from the root
  std::vector<Vec3> position;
  std::vector<double> weight;  // sum of the vertex weights
  std::vector<Vec3> skin;      // centroid of what the node moves, by weight; its position where it moves nothing
  // Moves skin, itself or through those under it. Where nothing has weights (motion capture) every node.
  std::vector<bool> alive;
  std::vector<double> reach;  // longest way down to a leaf that is alive
  std::vector<Vec3> tip;      // that leaf's position
  double size = 0;            // largest distance from the mean of what is alive

  int count() const { return static_cast<int>(parent.size()); }
  int common_ancestor(int a, int b) const;  // -1 none
  std::vector<int> path(int from, int to) const;
  // For every node what `of(node)` says, or what holds for its parent.
  template <typename Of>
  std::vector<int> inherited(const Of& of) const {
    std::vector<int> values(parent.size(), -1);
    for (int n = 0; n < count(); ++n) {
      values[n] = of(n);
      if (values[n] < 0 && parent[n] >= 0) values[n] = values[parent[n]];
    }
    return values;
  }
  double bone(int node) const;  // distance to the parent
  double length(const std::vector<int>& path) const;
};

Skeleton make_skeleton(const SourceRig& rig, const std::vector<Vec3>& positions);

}  // namespace spherechain::baker
