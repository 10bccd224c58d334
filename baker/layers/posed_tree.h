// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "baker/layers/skin.h"

namespace spherechain::baker {

// Boxes around a skin's opaque triangles, as a tree that is built at rest once and then follows the pose.
class PosedTree {
 public:
  // `skin` must outlive it. It has an opaque triangle.
  explicit PosedTree(const LayeredSkin& skin);

  // `positions` of the source's vertices must live until the last call of is_free().
  void pose(const std::vector<Vec3>& positions);

  // True if an eye far away in the direction `eye` sees the middle of the triangle.
  bool is_free(Index triangle, const Vec3& eye) const;

 private:
  // The left child is the next node; a leaf has no right one.
  struct Node {
    Eigen::AlignedBox3d box;
    Index right = kNoIndex;
    Index first = 0, count = 0;  // of order_
  };
  void build(Index first, Index count, const std::vector<Vec3>& middles);
  bool hides(Index triangle, const Vec3& from, const Vec3& eye) const;

  const LayeredSkin& skin_;
  const std::vector<Vec3>* positions_ = nullptr;
  std::vector<Index> order_;
  std::vector<Node> nodes_;
};

}  // namespace spherechain::baker
