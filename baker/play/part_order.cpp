// SPDX-License-Identifier: GPL-3.0-or-later
#include "play/part_order.h"

namespace spherechain::baker {

PartOrder::PartOrder(const AnimatedAsset& animated) {
  const BodyParts parts = parts_of(animated.asset());
  const Character& character = animated.character();
  for (const BodyPart& part : parts.parts) {
    int joints = 0;
    for (int p = part.parent; p >= 0; p = parts.parts[static_cast<std::size_t>(p)].parent) ++joints;
    ranks_.emplace_back(joints, 0);
  }
  for (std::size_t t = 0; t < parts.of_triangle.size(); ++t) {
    if (parts.of_triangle[t] >= ranks_.size()) continue;
    const Triangle& triangle = character.source_triangles[t];
    const Vec3& a = character.source_positions[triangle[0]];
    ranks_[parts.of_triangle[t]].second -=
        (character.source_positions[triangle[1]] - a).cross(character.source_positions[triangle[2]] - a).norm();
  }
}

}  // namespace spherechain::baker
