// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <set>

#include "motion/poses.h"
#include "roles/roles.h"

namespace spherechain::baker {

std::vector<Joint> own_joints(const SourceRig& rig) {
  const std::vector<Vec3> positions = rest_positions(rig);
  std::vector<int> first(rig.nodes.size(), -1);  // a node's first bone
  for (std::size_t b = rig.bones.size(); b-- > 0;) first[rig.bones[b].node] = static_cast<int>(b);
  std::vector<Joint> out;
  std::set<std::string> taken;
  for (std::size_t b = 0; b < rig.bones.size(); ++b) {
    const Index node = rig.bones[b].node;
    const std::string& name = rig.nodes[node].name;
    std::string own = name;
    for (int number = 2; !taken.insert(own).second; ++number) own = name + " " + std::to_string(number);
    // A node that two skins bind differently has two bones: the second follows the first.
    int parent = first[node] < static_cast<int>(b) ? first[node] : -1;
    for (int above = rig.nodes[node].parent; parent < 0 && above >= 0;
         above = rig.nodes[static_cast<std::size_t>(above)].parent) {
      parent = first[static_cast<std::size_t>(above)];
    }
    const Affine& bind = rig.bones[b].inverse_bind;
    const Vec3 position =
        std::abs(bind.linear().determinant()) > 0 ? Vec3(bind.inverse().translation()) : positions[node];
    out.push_back({own, parent, position, position});
  }
  return out;
}

}  // namespace spherechain::baker
