// SPDX-License-Identifier: MIT
// When do two moving triangles first touch?
#pragma once

#include "runtime/src/base/double3.h"
#include "runtime/src/triangles/exact_triangles.h"

namespace spherechain {

// Corners of two triangles at one time: three of a, then three of b.
struct SixCorners {
  Double3 p[6];

  TriangleCorners triangle(std::size_t first) const {
    return {{to_float(p[first]), to_float(p[first + 1]), to_float(p[first + 2])}};
  }
};

// From `from` to `to` all corners go straight, but for `stray`, of a corner of a and one of b together.
struct CornerPaths {
  SixCorners from, to;
  double stray;
  double step;      // of the corners' distances from each other: what they may change by between two looks
  double shortest;  // share of the way between two looks, at least, however far they move

  SixCorners at(double t) const;
};

enum class Outcome { kApart, kTouch, kTooCoarse };
struct Approach {
  Outcome outcome;
  double time;  // of kTouch, and of kTooCoarse: until then they are apart
};

// Looks along the way up to `limit` for the first time at which the triangles intersect, exactly and as rounded to
// floats. Between two looks that are not known to be apart no two corners change their distance by more than `step`,
// but where the motion is so long that `shortest` counts. When it looks does not depend on the limit.
//
// For a direction n the gap of the two triangles, min n.b - max n.a, is a minimum of linear functions of time: when it
// closes is known. From a time on, the direction is taken whose gap stays open longest, of those that part the
// triangles then; and again from when it closes. Where `stray` is more than a quarter of a step, and the gap is not
// wider, kTooCoarse.
Approach approach(const CornerPaths& way, double limit);

}  // namespace spherechain
