// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/layers/posed_tree.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace spherechain::baker {
namespace {

constexpr Index kLeaf = 4;  // triangles

// True if a ray that starts at `from` meets the box. `inverse`: 1 by the direction, in each axis.
bool meets(const Eigen::AlignedBox3d& box, const Vec3& from, const Vec3& inverse) {
  double near = 0, far = HUGE_VAL;
  for (int k = 0; k < 3; ++k) {
    const double a = (box.min()[k] - from[k]) * inverse[k], b = (box.max()[k] - from[k]) * inverse[k];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  return near <= far;
}

}  // namespace

PosedTree::PosedTree(const LayeredSkin& skin) : skin_(skin) {
  std::vector<Vec3> middles;
  for (Index t = 0; t < skin.rest.triangles.size(); ++t) {
    middles.push_back(triangle_centroid(skin.rest, t));
    if (skin.is_opaque[t] != 0) order_.push_back(t);
  }
  build(0, static_cast<Index>(order_.size()), middles);
}

void PosedTree::build(Index first, Index count, const std::vector<Vec3>& middles) {
  const std::size_t node = nodes_.size();
  nodes_.push_back({{}, kNoIndex, first, count});
  if (count <= kLeaf) return;
  const auto begin = order_.begin() + first;
  Eigen::AlignedBox3d box;
  for (Index i = 0; i < count; ++i) box.extend(middles[begin[i]]);
  int axis = 0;
  box.sizes().maxCoeff(&axis);
  std::nth_element(begin, begin + count / 2, begin + count,
                   [&](Index l, Index r) { return middles[l][axis] < middles[r][axis]; });
  build(first, count / 2, middles);
  nodes_[node].right = static_cast<Index>(nodes_.size());
  build(first + count / 2, count - count / 2, middles);
}

void PosedTree::pose(const std::vector<Vec3>& positions) {
  positions_ = &positions;
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    if (node.right != kNoIndex) {
      node.box = nodes_[n + 1].box.merged(nodes_[node.right].box);
      continue;
    }
    node.box.setEmpty();
    for (Index i = node.first; i < node.first + node.count; ++i) {
      for (const Index v : skin_.rest.triangles[order_[i]]) node.box.extend(positions[v]);
    }
  }
}

// A triangle that is drawn from one side hides nothing from an eye behind it.
bool PosedTree::hides(Index triangle, const Vec3& from, const Vec3& eye) const {
  const Triangle& v = skin_.rest.triangles[triangle];
  const Vec3& a = (*positions_)[v[0]];
  const Vec3 ab = (*positions_)[v[1]] - a, ac = (*positions_)[v[2]] - a, start = from - a, p = eye.cross(ac);
  const double area = ab.dot(p);
  if (area == 0 || (area > 0 && skin_.is_two_sided[triangle] == 0)) return false;
  const double b = start.dot(p) / area;
  if (b < 0 || b > 1) return false;
  const Vec3 q = start.cross(ab);
  const double c = eye.dot(q) / area;
  return c >= 0 && b + c <= 1 && ac.dot(q) / area > 0;
}

bool PosedTree::is_free(Index triangle, const Vec3& eye) const {
  const Triangle& v = skin_.rest.triangles[triangle];
  const Vec3 from = ((*positions_)[v[0]] + (*positions_)[v[1]] + (*positions_)[v[2]]) / 3, inverse = eye.cwiseInverse();
  std::array<Index, 64> open{};  // the tree's depth is the logarithm of its size
  std::size_t count = 1;
  while (count > 0) {
    const Index n = open[--count];
    const Node& node = nodes_[n];
    if (!meets(node.box, from, inverse)) continue;
    if (node.right != kNoIndex) {
      open[count++] = node.right;
      open[count++] = n + 1;
      continue;
    }
    for (Index i = node.first; i < node.first + node.count; ++i) {
      if (order_[i] != triangle && hides(order_[i], from, eye)) return false;
    }
  }
  return true;
}

}  // namespace spherechain::baker
