// SPDX-License-Identifier: MIT
// Where a half-line meets boxes and triangles.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "runtime/src/depth/posed_skin.h"

namespace spherechain {

class Ray {
 public:
  Ray(const Double3& from, const Double3& direction)
      : from_(from),
        direction_(direction),
        start_{from.x, from.y, from.z},
        slope_{1 / direction.x, 1 / direction.y, 1 / direction.z} {}

  bool meets(const float* const (&low)[3], const float* const (&high)[3], std::size_t box) const {
    double enter = 0, leave = HUGE_VAL;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double s = (double{low[axis][box]} - start_[axis]) * slope_[axis];
      const double t = (double{high[axis][box]} - start_[axis]) * slope_[axis];
      enter = std::max(enter, std::min(s, t));
      leave = std::min(leave, std::max(s, t));
    }
    return !(enter > leave);
  }

  // How far it goes until it meets the triangle, in lengths of its direction; else infinite. (Moeller and Trumbore)
  double reach(const Corners& t) const {
    const Double3 e = t.p[1] - t.p[0], f = t.p[2] - t.p[0], p = cross(direction_, f);
    const double determinant = dot(e, p);
    if (!(determinant > 0) && !(determinant < 0)) {
      return HUGE_VAL;
    }
    const Double3 r = from_ - t.p[0];
    const double s = dot(r, p) / determinant;
    if (!(s >= 0 && s <= 1)) {
      return HUGE_VAL;  // most triangles
    }
    const Double3 q = cross(r, e);
    const double u = dot(direction_, q) / determinant, reach = dot(f, q) / determinant;
    return u >= 0 && s + u <= 1 && reach > 0 ? reach : HUGE_VAL;
  }

 private:
  Double3 from_, direction_;
  double start_[3], slope_[3];
};

}  // namespace spherechain
