// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/play/play.h"
#include "baker/truth/surface.h"

namespace spherechain::baker {

// Which contacts are between body parts that are far from each other: neither hangs on the other, both do not hang on
// the same third, and at rest they are at least `close` apart. No sphere has a say in it.
class FarParts {
 public:
  FarParts(const AnimatedAsset& animated, const TruthSurface& surface, double close);

  // `triangles` are two source triangles.
  bool operator()(const Pair& triangles) const { return far_[part_of_[triangles.a]][part_of_[triangles.b]]; }

 private:
  std::vector<std::uint8_t> part_of_;  // a source triangle -> its part
  std::vector<std::vector<bool>> far_;
};

}  // namespace spherechain::baker
