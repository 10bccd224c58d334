// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/truth/far_parts.h"

#include "baker/truth/intersections.h"

namespace spherechain::baker {

FarParts::FarParts(const AnimatedAsset& animated, const TruthSurface& surface, double close) {
  const BodyParts parts = body_parts_of(animated.asset());
  part_of_ = parts.of_triangle;
  const std::size_t count = parts.parts.size();
  far_.assign(256, std::vector<bool>(256, false));  // a triangle without a part is far from nothing
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = 0; b < count; ++b) {
      const int above_a = parts.parts[a].parent, above_b = parts.parts[b].parent;
      const bool hangs = above_a == static_cast<int>(b) || above_b == static_cast<int>(a);
      const bool siblings = above_a >= 0 && above_a == above_b;
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
