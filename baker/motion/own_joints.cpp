// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <map>
#include <set>

#include "baker/motion/poses.h"
#include "baker/roles/roles.h"

namespace spherechain::baker {

std::vector<Joint> own_joints(const SourceRig& rig) {
  const std::vector<Vec3> positions = rest_positions(rig);
  std::vector<int> first(rig.nodes.size(), -1);  // a node's first bone
  for (std::size_t b = rig.bones.size(); b-- > 0;) first[rig.bones[b].node] = static_cast<int>(b);
  std::vector<int> above(rig.nodes.size(), -1);  // a node's nearest bone above
  for (std::size_t n = 0; n < rig.nodes.size(); ++n) {
    const int up = rig.nodes[n].parent;
    if (up >= 0)
      above[n] = first[static_cast<std::size_t>(up)] >= 0 ? first[static_cast<std::size_t>(up)]
                                                          : above[static_cast<std::size_t>(up)];
  }
  std::vector<Joint> out;
  std::set<std::string> taken;
  std::map<std::string, int> next_number;
  for (std::size_t b = 0; b < rig.bones.size(); ++b) {
    const Index node = rig.bones[b].node;
    const std::string& name = rig.nodes[node].name;
    std::string own = name;
    int& number = next_number.try_emplace(name, 2).first->second;
    while (!taken.insert(own).second) own = name + " " + std::to_string(number++);
    // A node that two skins bind differently has two bones: the second follows the first.
    const int parent = first[node] < static_cast<int>(b) ? first[node] : above[node];
    const Affine& bind = rig.bones[b].inverse_bind;
    const bool is_bound = rig.pivots.empty() && std::abs(bind.linear().determinant()) > 0;
    const Vec3 position = is_bound ? Vec3(bind.inverse().translation()) : positions[node];
    out.push_back({own, parent, position, position});
  }
  return out;
}

}  // namespace spherechain::baker
