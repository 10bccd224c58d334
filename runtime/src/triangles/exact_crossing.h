// SPDX-License-Identifier: MIT
// Two triangles in different planes meet where their pieces of the planes' common line do. Which piece begins before
// the other ends is the sign of a determinant, so is everything else that is asked here: in double precision with an
// error bound, and exactly where that does not tell.
#pragma once

#include "runtime/src/base/double3.h"
#include "runtime/src/triangles/exact_orientation.h"
#include "runtime/src/triangles/exact_triangles.h"

namespace spherechain {

// Extent of both triangles together along an axis.
inline double extent_of(const TriangleCorners& a, const TriangleCorners& b, float Vec3::*axis) {
  float low = a.p[0].*axis, high = low;
  for (int i = 0; i < 3; ++i) {
    const float in_a = a.p[i].*axis, in_b = b.p[i].*axis;
    const float less = in_a < in_b ? in_a : in_b, more = in_a < in_b ? in_b : in_a;
    low = less < low ? less : low;
    high = more > high ? more : high;
  }
  return double{high} - double{low};
}

// 1, -1, or 0 where the filter cannot tell.
inline int certain_sign(double value, double error) { return value > error ? 1 : value < -error ? -1 : 0; }

// A triangle against the plane of another one.
struct Crossing {
  double distances[3];  // of the corners, times the length of the plane's normal
  int sides[3];

  bool is_missed() const {
    return (sides[0] > 0 && sides[1] > 0 && sides[2] > 0) || (sides[0] < 0 && sides[1] < 0 && sides[2] < 0);
  }
  bool is_within() const { return sides[0] == 0 && sides[1] == 0 && sides[2] == 0; }
};

// Signs that are exact, for triangles of which none is missed.
struct Crossings {
  Crossing b_in_a, a_in_b;
};

inline Double3 normal_of(const TriangleCorners& t) {
  return cross(difference(t.p[1], t.p[0]), difference(t.p[2], t.p[0]));
}

// Sides by the floating-point filter; a side that it cannot decide becomes 0.
inline void measure(const TriangleCorners& plane, const TriangleCorners& t, double error, Crossing& out) {
  const Double3 normal = normal_of(plane);
  for (int i = 0; i < 3; ++i) {
    out.distances[i] = dot(normal, difference(t.p[i], plane.p[0]));
    out.sides[i] = certain_sign(out.distances[i], error);
  }
}

inline void settle(const TriangleCorners& plane, const TriangleCorners& t, Crossing& out) {
  for (int i = 0; i < 3; ++i) {
    if (out.sides[i] == 0) {
      out.sides[i] = side_of_plane(plane.p[0], plane.p[1], plane.p[2], t.p[i]);
    }
  }
}

// The corner that is alone, and the other two: it is not below the plane, they are not above. Both of its edges cross
// the plane, and neither lies in it. Where that is so only with the plane turned over, so it is.
struct Arrangement {
  int alone, second, third;
  bool turns;
};

inline Arrangement arrange(const int (&sides)[3]) {
  for (int i = 0; i < 3; ++i) {
    const int second = (i + 1) % 3, third = (i + 2) % 3;
    const int sum = sides[second] + sides[third];
    const bool others_below = sides[second] <= 0 && sides[third] <= 0;
    const bool others_above = sides[second] >= 0 && sides[third] >= 0;
    if (sides[i] > 0 && others_below) return {i, second, third, false};
    if (sides[i] < 0 && others_above) return {i, second, third, true};
    if (sides[i] == 0 && sum == -2) return {i, second, third, false};
    if (sides[i] == 0 && sum == 2) return {i, second, third, true};
  }
  return {0, 1, 2, false};  // not for sides that cross and are not all 0
}

// Two triangles that cross each other's planes, in different planes: p, q, r and u, v, w, p and u alone. Along the
// common line a's piece goes from pr to pq, b's from uv to uw.
struct Pieces {
  const TriangleCorners* a;
  const TriangleCorners* b;
  int p, q, r, u, v, w;
  double error;

  // Is `uv`'s point after (1), at (0) or before (-1) the point of `pq`?
  int order(int pq, int uv) const {
    const Vec3 &start = a->p[p], &end = a->p[pq], &other_start = b->p[u], &other_end = b->p[uv];
    const double volume =
        dot(cross(difference(end, start), difference(other_start, start)), difference(other_end, start));
    const int sign = certain_sign(volume, error);
    return sign != 0 ? sign : side_of_plane(start, end, other_start, other_end);
  }
  bool overlap() const { return order(q, v) <= 0 && order(r, w) >= 0; }
};

inline Pieces pieces_of(const TriangleCorners& a, const TriangleCorners& b, const Crossings& crossings, double error) {
  const Arrangement of_a = arrange(crossings.a_in_b.sides), of_b = arrange(crossings.b_in_a.sides);
  Pieces pieces{&a, &b, of_a.alone, of_a.second, of_a.third, of_b.alone, of_b.second, of_b.third, error};
  if (of_b.turns) {  // a's plane
    pieces.q = of_a.third;
    pieces.r = of_a.second;
  }
  if (of_a.turns) {
    pieces.v = of_b.third;
    pieces.w = of_b.second;
  }
  return pieces;
}

inline double error_of(const TriangleCorners& a, const TriangleCorners& b) {
  return determinant_error(extent_of(a, b, &Vec3::x), extent_of(a, b, &Vec3::y), extent_of(a, b, &Vec3::z));
}

inline bool cross_each_other(const TriangleCorners& a, const TriangleCorners& b, double error, Crossings& out) {
  measure(a, b, error, out.b_in_a);
  measure(b, a, error, out.a_in_b);
  if (out.b_in_a.is_missed() || out.a_in_b.is_missed()) {
    return false;
  }
  settle(a, b, out.b_in_a);
  if (out.b_in_a.is_missed()) {
    return false;
  }
  settle(b, a, out.a_in_b);
  return !out.a_in_b.is_missed();
}

inline bool are_in_one_plane(const Crossings& crossings) {
  return crossings.b_in_a.is_within() || crossings.a_in_b.is_within();
}

}  // namespace spherechain
