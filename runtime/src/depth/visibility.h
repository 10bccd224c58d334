// SPDX-License-Identifier: MIT
#pragma once

#include "depth/contour.h"

namespace spherechain {

// What of a contour can be seen from far away.
class Visibility {
 public:
  explicit Visibility(const PosedSkin& skin) : skin_(skin) {}

  // The share of the contour's length, of samples, from which some ray leaves the body without meeting it. Rays start
  // `clearance` away from the skin, between the two surfaces. `axes` are three directions at right angles.
  double share(const Contour& contour, const Double3 (&axes)[3], double clearance) const;

 private:
  bool is_free(const Double3& from, const Double3& direction) const;

  const PosedSkin& skin_;
};

}  // namespace spherechain
