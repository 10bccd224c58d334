// SPDX-License-Identifier: MIT
// Where two triangles that intersect do so: rounded, but for which piece of the common line ends first.
#include <cmath>
#include <initializer_list>

#include "runtime/src/triangles/exact_crossing.h"

namespace spherechain {
namespace {

// The point at that share of an edge, kept on it.
Vec3 point_at(double share, const Vec3& start, const Double3& edge) {
  const double part = share > 0 ? share < 1 ? share : 1 : 0;
  return {static_cast<float>(double{start.x} + part * edge.x), static_cast<float>(double{start.y} + part * edge.y),
          static_cast<float>(double{start.z} + part * edge.z)};
}

// Where a triangle's edge crosses the plane its distances are from.
Vec3 point_on(const TriangleCorners& t, const Crossing& crossing, int from, int to) {
  const double length = crossing.distances[from] - crossing.distances[to];
  const double share = length < 0 || length > 0 ? crossing.distances[from] / length : 0;
  return point_at(share, t.p[from], difference(t.p[to], t.p[from]));
}

// From the later of the beginnings to the earlier of the ends.
Segment common_segment(const Pieces& pieces, const Crossings& crossings) {
  const auto& [a, b, p, q, r, u, v, w, error] = pieces;
  return {pieces.order(r, v) > 0 ? point_on(*b, crossings.b_in_a, u, v) : point_on(*a, crossings.a_in_b, p, r),
          pieces.order(q, w) > 0 ? point_on(*a, crossings.a_in_b, p, q) : point_on(*b, crossings.b_in_a, u, w)};
}

struct Piece {
  Vec3 from, to;
  double length;  // of its edge, times the share of the edge; the piece is the better the longer
};

// The piece of the edge that is inside of the triangle, both in one plane of that normal: rounded, so where they only
// touch the piece may come out a little less than nothing.
Piece clip(const Vec3& start, const Vec3& end, const TriangleCorners& t, const Double3& normal) {
  double first = 0, last = 1;
  const Double3 edge = difference(end, start);
  for (int i = 0; i < 3; ++i) {
    const Double3 inwards = cross(normal, difference(t.p[(i + 1) % 3], t.p[i]));
    const double at_start = dot(inwards, difference(start, t.p[i]));
    const double slope = dot(inwards, edge);
    if (slope > 0 && -at_start > first * slope) first = -at_start / slope;
    if (slope < 0 && at_start < last * -slope) last = at_start / -slope;
    if (!(slope < 0) && !(slope > 0) && at_start < 0) last = -1;  // beside it
  }
  return {point_at(first, start, edge), point_at(last, start, edge), (last - first) * std::sqrt(dot(edge, edge))};
}

Segment flat_segment(const TriangleCorners& a, const TriangleCorners& b) {
  const Double3 normal_a = normal_of(a), normal_b = normal_of(b);
  Piece best{a.p[0], a.p[0], -HUGE_VAL};
  for (int i = 0; i < 3; ++i) {
    for (const Piece& piece :
         {clip(a.p[i], a.p[(i + 1) % 3], b, normal_b), clip(b.p[i], b.p[(i + 1) % 3], a, normal_a)}) {
      best = piece.length > best.length ? piece : best;
    }
  }
  return {best.from, best.to};
}

}  // namespace

Segment crossing_segment(const TriangleCorners& a, const TriangleCorners& b) noexcept {
  const double error = error_of(a, b);
  Crossings crossings{};
  return cross_each_other(a, b, error, crossings) && !are_in_one_plane(crossings)
             ? common_segment(pieces_of(a, b, crossings, error), crossings)
             : flat_segment(a, b);
}

}  // namespace spherechain
