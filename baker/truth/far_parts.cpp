// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/far_parts.h"

#include <map>

#include "truth/intersections.h"

namespace spherechain::baker {
namespace {

// The part that each part hangs on: that of the nearest bone above which a part follows; -1 none.
std::vector<int> parts_above(const AnimatedAsset& animated, const std::vector<BodyPart>& parts) {
  const OpenAsset& asset = animated.asset();
  const SourceRig& rig = animated.character().rig;
  // The source's nodes, or the joints of the automatic rig.
  const bool own_rig = !rig.bones.empty();
  const auto node_of = [&](const BodyPart& part) {
    const auto bone = static_cast<std::size_t>(part.bone);
    if (!own_rig) return part.bone;
    return part.bone >= 0 && bone < rig.bones.size() ? static_cast<int>(rig.bones[bone].node) : -1;
  };
  const auto above = [&](int node) {
    const auto n = static_cast<std::size_t>(node);
    return own_rig ? rig.nodes[n].parent : asset->joint(n).parent;
  };
  std::map<int, int> part_at;
  for (std::size_t p = 0; p < parts.size(); ++p) part_at[node_of(parts[p])] = static_cast<int>(p);
  part_at.erase(-1);
  std::vector<int> out;
  for (const BodyPart& part : parts) {
    int node = node_of(part);
    if (node >= 0) node = above(node);
    while (node >= 0 && part_at.count(node) == 0) node = above(node);
    out.push_back(node < 0 ? -1 : part_at[node]);
  }
  return out;
}

}  // namespace

FarParts::FarParts(const AnimatedAsset& animated, const TruthSurface& surface, double close) {
  const BodyParts parts = parts_of(animated.asset());
  part_of_ = parts.of_triangle;
  const std::vector<int> above = parts_above(animated, parts.parts);
  const std::size_t count = above.size();
  far_.assign(256, std::vector<bool>(256, false));  // a triangle without a part is far from nothing
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = 0; b < count; ++b) {
      const bool hangs = above[a] == static_cast<int>(b) || above[b] == static_cast<int>(a);
      const bool siblings = above[a] >= 0 && above[a] == above[b];
      far_[a][b] = a != b && !hangs && !siblings;
    }
  }
  std::vector<std::uint32_t> owner;
  for (const Index triangle : surface.source_triangle) owner.push_back(part_of_[triangle]);
  for (const Pair& pair : close_owners(surface, pack(animated.character().source_positions), owner, close)) {
    far_[pair.a][pair.b] = far_[pair.b][pair.a] = false;
  }
}

}  // namespace spherechain::baker
