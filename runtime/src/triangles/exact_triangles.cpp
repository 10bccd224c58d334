// SPDX-License-Identifier: MIT
#include "runtime/src/triangles/exact_triangles.h"

#include <algorithm>
#include <cmath>

#include "runtime/src/triangles/exact_crossing.h"

namespace spherechain {
namespace {

// A triangle seen along an axis from whichever side it goes round against the clock.
struct FlatTriangle {
  Vec2 p[3];
};

Vec2 flat(const Vec3& p, int axis) { return axis == 0 ? Vec2{p.y, p.z} : axis == 1 ? Vec2{p.z, p.x} : Vec2{p.x, p.y}; }

// False where seen so it is a line.
bool flatten(const TriangleCorners& t, int axis, FlatTriangle& out) {
  const Vec2 a = flat(t.p[0], axis), b = flat(t.p[1], axis), c = flat(t.p[2], axis);
  const int turn = side_of_line(a, b, c);
  out = turn > 0 ? FlatTriangle{{a, b, c}} : FlatTriangle{{a, c, b}};
  return turn != 0;
}

// Is all of `b` strictly outside of one of a's edges?
bool has_separating_edge(const FlatTriangle& a, const FlatTriangle& b) {
  for (int i = 0; i < 3; ++i) {
    const Vec2 &from = a.p[i], &to = a.p[(i + 1) % 3];
    if (side_of_line(from, to, b.p[0]) < 0 && side_of_line(from, to, b.p[1]) < 0 &&
        side_of_line(from, to, b.p[2]) < 0) {
      return true;
    }
  }
  return false;
}

// True if two triangles in one plane intersect, or two of which one is degenerate: that one is a line along every axis.
bool flat_triangles_intersect(const TriangleCorners& a, const TriangleCorners& b) {
  for (int axis = 0; axis < 3; ++axis) {
    FlatTriangle flat_a, flat_b;
    if (flatten(a, axis, flat_a) && flatten(b, axis, flat_b)) {
      return !has_separating_edge(flat_a, flat_b) && !has_separating_edge(flat_b, flat_a);
    }
  }
  return false;
}

bool is_finite(const TriangleCorners& t) {
  bool finite = true;
  for (const Vec3& p : t.p) {
    finite = finite && std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
  }
  return finite;
}

}  // namespace

bool is_point(const TriangleCorners& t) noexcept {
  float most = 0, extent = 0;
  for (float Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    const float low = std::min({t.p[0].*axis, t.p[1].*axis, t.p[2].*axis});
    const float high = std::max({t.p[0].*axis, t.p[1].*axis, t.p[2].*axis});
    most = std::max({most, -low, high});
    extent = std::max(extent, high - low);
  }
  return extent <= kPointSize * most;
}

bool triangles_intersect(const TriangleCorners& a, const TriangleCorners& b) noexcept {
  const double error = error_of(a, b);
  Crossings crossings{};
  if (!cross_each_other(a, b, error, crossings)) {
    return false;
  }
  const bool intersect =
      are_in_one_plane(crossings) ? flat_triangles_intersect(a, b) : pieces_of(a, b, crossings, error).overlap();
  return intersect && is_finite(a) && is_finite(b) && !is_point(a) && !is_point(b);  // last: most are sound
}

}  // namespace spherechain
