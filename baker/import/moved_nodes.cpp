// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/moved_nodes.h"

namespace spherechain::baker {

MovedNodes::MovedNodes(const SourceRig& rig, const std::vector<std::uint8_t>& moves, const std::vector<Index>& wanted)
    : place_(rig.nodes.size(), -1), rest_(world_of(rig.nodes)) {
  const std::vector<Node>& nodes = rig.nodes;
  std::vector<std::uint8_t> is_wanted(nodes.size(), 0), is_moved(moves);
  for (const Bone& bone : rig.bones) is_wanted[bone.node] = 1;
  for (const Index n : wanted) is_wanted[n] = 1;
  for (std::size_t n = nodes.size(); n-- > 0;) {
    if (is_wanted[n] != 0 && nodes[n].parent >= 0) is_wanted[static_cast<std::size_t>(nodes[n].parent)] = 1;
  }
  for (Index n = 0; n < nodes.size(); ++n) {
    if (nodes[n].parent >= 0 && is_moved[static_cast<std::size_t>(nodes[n].parent)] != 0) is_moved[n] = 1;
    if (is_wanted[n] == 0 || is_moved[n] == 0) continue;
    place_[n] = static_cast<int>(list_.size());
    list_.push_back(n);
  }
  for (Index b = 0; b < rig.bones.size(); ++b) {
    const Bone& bone = rig.bones[b];
    bones_at_rest_.push_back(rig.to_rest * rest_[bone.node] * bone.inverse_bind);
    if (place_[bone.node] >= 0) moved_bones_.push_back(b);
  }
}

std::vector<Affine> MovedNodes::deformation(const SourceRig& rig, const std::vector<Affine>& moved) const {
  std::vector<Affine> out = bones_at_rest_;
  for (const Index b : moved_bones_) {
    out[b] = rig.to_rest * world(rig.bones[b].node, moved) * rig.bones[b].inverse_bind;
  }
  return out;
}

}  // namespace spherechain::baker
