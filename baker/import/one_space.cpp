// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/one_space.h"

#include <algorithm>
#include <cmath>

namespace spherechain::baker {

bool were_bound_in_one_space(const std::vector<Node>& nodes, const std::vector<BoundJoint>& joints) {
  std::vector<const BoundJoint*> of_node(nodes.size(), nullptr);
  std::vector<std::size_t> leader;  // of a skin: the first skin that joints lead to
  Eigen::AlignedBox3d box;
  for (const BoundJoint& joint : joints) {
    while (leader.size() <= joint.skin) leader.push_back(leader.size());
    if (!joint.place.matrix().allFinite() || !(std::abs(joint.place.linear().determinant()) > 0)) return false;
    box.extend(Vec3(joint.place.translation()));
  }
  constexpr double kSame = 1e-3;  // of the joints' extent
  const auto join = [&](const BoundJoint& a, const BoundJoint& b, const Vec3& shift) {
    const std::size_t from = leader[a.skin], to = leader[b.skin];
    std::replace(leader.begin(), leader.end(), std::max(from, to), std::min(from, to));
    return (a.place * shift - b.place.translation()).norm() <= kSame * box.diagonal().norm();
  };
  for (const BoundJoint& joint : joints) {
    const BoundJoint*& first = of_node[joint.node];
    if (first == nullptr) first = &joint;
    if (!join(*first, joint, Vec3::Zero())) return false;
  }
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    if (of_node[n] == nullptr) continue;
    Affine local = nodes[n].local;
    int above = nodes[n].parent;
    while (above >= 0 && of_node[static_cast<std::size_t>(above)] == nullptr) {
      local = nodes[static_cast<std::size_t>(above)].local * local;
      above = nodes[static_cast<std::size_t>(above)].parent;
    }
    if (above >= 0 && !join(*of_node[static_cast<std::size_t>(above)], *of_node[n], local.translation())) return false;
  }
  return std::all_of(leader.begin(), leader.end(), [&](std::size_t skin) { return skin == leader.front(); });
}

}  // namespace spherechain::baker
