// SPDX-License-Identifier: MIT
// Where two triangles that intersect do so: rounded, but for which piece of the common line ends first.
#include <cmath>

#include "skin/exact_crossing.h"

namespace spherechain {
namespace {

// Where a triangle's edge crosses the plane its distances are from.
Vec3 point_on(const TriangleCorners& t, const Crossing& crossing, int from, int to) {
  const double length = crossing.distances[from] - crossing.distances[to];
  const double part = length < 0 || length > 0 ? crossing.distances[from] / length : 0;
  const double share = part > 0 ? part < 1 ? part : 1 : 0;
  const Vec3 &start = t.p[from], &end = t.p[to];
  const Double3 edge = difference(end, start);
  return {static_cast<float>(double{start.x} + share * edge.x), static_cast<float>(double{start.y} + share * edge.y),
          static_cast<float>(double{start.z} + share * edge.z)};
}

// From the later of the beginnings to the earlier of the ends.
void lay_segment(const Pieces& pieces, const Crossings& crossings, Segment& out) {
  const auto& [a, b, p, q, r, u, v, w, error] = pieces;
  out.from = pieces.order(r, v) > 0 ? point_on(*b, crossings.b_in_a, u, v) : point_on(*a, crossings.a_in_b, p, r);
  out.to = pieces.order(q, w) > 0 ? point_on(*a, crossings.a_in_b, p, q) : point_on(*b, crossings.b_in_a, u, w);
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
  const auto point = [&](double share) {
    const double part = share > 0 ? share < 1 ? share : 1 : 0;
    return Vec3{static_cast<float>(double{start.x} + part * edge.x),
                static_cast<float>(double{start.y} + part * edge.y),
                static_cast<float>(double{start.z} + part * edge.z)};
  };
  return {point(first), point(last), (last - first) * std::sqrt(dot(edge, edge))};
}

void lay_flat_segment(const TriangleCorners& a, const TriangleCorners& b, Segment& out) {
  const Double3 normal = normal_of(a);
  const Double3 own = normal_of(b);
  Piece best{a.p[0], a.p[0], -HUGE_VAL};
  for (int i = 0; i < 3; ++i) {
    const Piece pieces[] = {clip(a.p[i], a.p[(i + 1) % 3], b, own), clip(b.p[i], b.p[(i + 1) % 3], a, normal)};
    for (const Piece& piece : pieces) {
      best = piece.length > best.length ? piece : best;
    }
  }
  out.from = best.from;
  out.to = best.to;
}

}  // namespace

Segment crossing_segment(const TriangleCorners& a, const TriangleCorners& b) noexcept {
  const double error = error_of(a, b);
  Crossings crossings{};
  Segment out{};
  const bool cross = cross_each_other(a, b, error, crossings);
  if (!cross || are_in_one_plane(crossings)) {
    lay_flat_segment(a, b, out);
  } else {
    lay_segment(pieces_of(a, b, crossings.a_in_b, crossings.b_in_a, error), crossings, out);
  }
  return out;
}

}  // namespace spherechain
