// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "play/play.h"

namespace spherechain::baker {

// Which of two body parts that meet is named first. A hand is in a thigh, a foot in a shin: the first is the one that
// hangs farther out; of two alike the smaller.
class PartOrder {
 public:
  PartOrder() = default;  // of no parts
  explicit PartOrder(const AnimatedAsset& animated);

  // Whether `part_a`, the one with the lesser number, comes first.
  bool is_first(std::size_t part_a, std::size_t part_b) const { return ranks_[part_a] > ranks_[part_b]; }
  std::pair<std::size_t, std::size_t> ordered(std::size_t part_a, std::size_t part_b) const {
    return is_first(part_a, part_b) ? std::pair(part_a, part_b) : std::pair(part_b, part_a);
  }

 private:
  std::vector<std::pair<int, double>> ranks_;  // joints above it, and less its area
};

}  // namespace spherechain::baker
