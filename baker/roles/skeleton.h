// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/import/source_rig.h"

namespace spherechain::baker {

// A rig's nodes as a tree in the rest pose; parents come before their children.
struct Skeleton {
  std::vector<std::string> names;
  std::vector<int> parent;
  std::vector<std::vector<int>> children;
  std::vector<int> depth;  // steps from the root
  std::vector<Vec3> position;
  std::vector<double> weight;  // sum of the vertex weights
  std::vector<Vec3> skin;      // weighted centroid of the vertices it moves; its position where it moves none
  // True if the node or one below it moves skin. True for all nodes where there are no weights (motion capture).
  std::vector<bool> alive;
  std::vector<int> joint;     // the joint that a node belongs to that is none itself (joint_parts.h); -1 for others
  std::vector<double> reach;  // length of the longest path down to a tip that is alive
  std::vector<Vec3> tip;      // that tip's position
  double size = 0;            // largest distance of a living node from their mean
  bool is_mirrored = false;   // the scene shows the mirror image of the rest pose

  // Sets depth, reach, tip and size from the rest.
  void measure();
  int count() const { return static_cast<int>(parent.size()); }
  int common_ancestor(int a, int b) const;  // -1 none
  std::vector<int> path(int from, int to) const;
  // For every node the value of `of`, or its parent's value where that is negative.
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
