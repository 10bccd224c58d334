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

// Twice the area, > 0 where the triangle's front is seen by one who looks against d.
inline double turn_of(const Corners& t) {
  return (t.p[1].x - t.p[0].x) * (t.p[2].y - t.p[0].y) - (t.p[2].x - t.p[0].x) * (t.p[1].y - t.p[0].y);
}

// A triangle's plane in view: z = z0 + x_slope (x - x0) + y_slope (y - y0). Not finite if the triangle is seen edge-on.
struct Slope {
  double x0, y0, z0, x_slope, y_slope;

  explicit Slope(const Corners& t) : x0(t.p[0].x), y0(t.p[0].y), z0(t.p[0].z) {
    const Double3 e = t.p[1] - t.p[0], f = t.p[2] - t.p[0];
    const double determinant = e.x * f.y - f.x * e.y;
    x_slope = (e.z * f.y - f.z * e.y) / determinant;
    y_slope = (e.x * f.z - f.x * e.z) / determinant;
  }
  double at(double x, double y) const { return z0 + (x_slope * (x - x0) + y_slope * (y - y0)); }
};

// A triangle in view, with what each pair that it is part of needs.
struct SeenTriangle {
  Corners corners;
  double turn, size;  // see turn_of(); the square of its normal's length
  Slope slope;

  explicit SeenTriangle(const Corners& t) : corners(t), turn(turn_of(t)), size(0), slope(t) {
    const Double3 normal = normal_of(t);
    size = dot(normal, normal);
  }
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
  Shadow(const SeenTriangle& a, const SeenTriangle& b, double above, double below);
  // Leaves what rises at least, or at most, so far.
  void keep_above(double rise);
  void keep_below(double rise);
  double area() const;    // >= 0
  double volume() const;  // of the rise over the area
};

}  // namespace spherechain
