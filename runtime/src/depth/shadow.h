// SPDX-License-Identifier: MIT
// Two triangles seen along a direction: where they hide each other, and how far one is behind the other there.
#pragma once

#include "runtime/src/depth/posed_skin.h"

namespace spherechain {

// Axes u, v, d of unit length, u x v = d.
struct View {
  Double3 u, v, d, origin;

  explicit View(const Double3& direction, const Double3& center);
  // Coordinates along u, v and d.
  Double3 seen(const Double3& p) const {
    const Double3 q = p - origin;
    return {dot(u, q), dot(v, q), dot(d, q)};
  }
  Corners seen(const Corners& t) const { return {{seen(t.p[0]), seen(t.p[1]), seen(t.p[2])}}; }
  Double3 back(const Double3& p) const { return origin + (p.x * u + (p.y * v + p.z * d)); }
};

// The common part of two triangles seen along d: a convex polygon. `rise` is how far b must move along d to meet a
// there.
struct Shadow {
  static constexpr int kCornersMax = 12;
  struct Corner {
    double x, y, rise;
    int edge;  // that goes on from here: 0 to 2 of b, 3 to 5 of a
  };
  Corner corners[kCornersMax];
  int count = 0;            // 0: they do not hide each other
  bool stands_on_a = true;  // the plane of a, not of b, gives the heights: it is not seen edge-on

  // May stay empty where it rises nowhere above `above`, or everywhere beyond `below`.
  Shadow(const Corners& a, const Corners& b, double above, double below);
  // Leaves what rises at least, or at most, so far.
  void keep_above(double rise);
  void keep_below(double rise);
  double area() const;    // >= 0
  double volume() const;  // of the rise over the area
};

// Twice the area, > 0 where the triangle's front is seen by one who looks against d.
inline double turn_of(const Corners& t) {
  return (t.p[1].x - t.p[0].x) * (t.p[2].y - t.p[0].y) - (t.p[2].x - t.p[0].x) * (t.p[1].y - t.p[0].y);
}

// How far above the corners' plane; of a triangle that is not seen edge-on.
double height_at(const Corners& t, double x, double y);

}  // namespace spherechain
