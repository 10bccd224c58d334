// SPDX-License-Identifier: MIT
#pragma once

#include "depth/contour.h"

namespace spherechain {

// What of a contour can be seen from far away.
class Visibility {
 public:
  explicit Visibility(const PosedSkin& skin) : skin_(skin) {}

  // The share of the contour's segments, of samples, from which some ray leaves the body without meeting it. Rays start
  // `clearance` away from the skin, between the two surfaces. `axes` are three directions at right angles.
  double share(const Contour& contour, const Double3 (&axes)[3], double clearance);

 private:
  bool is_free(const Double3& from, const Double3& direction);
  // `free`: a direction to try first; the one that is free, where another is.
  bool is_seen(const Segment3& segment, const Double3 (&axes)[3], double clearance, Double3& free);

  const PosedSkin& skin_;
  // Triangles that rays met last: likely to stop the next.
  static constexpr std::size_t kBlockers = 8;
  std::uint32_t blockers_[kBlockers];
  std::size_t next_blocker_ = 0;
};

}  // namespace spherechain
