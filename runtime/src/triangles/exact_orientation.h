// SPDX-License-Identifier: MIT
// On which side a point lies, of a plane or of a line: exactly, for any finite floats.
#pragma once

#include "spherechain/types.h"

namespace spherechain {

// Seen from the side that (b - a) x (c - a) points to, a, b, c go round against the clock. 1: d is on that side; -1: on
// the other; 0: in the plane, or a, b, c are on one line. No filter: for what a filter could not decide.
int side_of_plane(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) noexcept;

struct Vec2 {
  float x, y;
};

// 1 where a, b, c go round against the clock, -1 with it, 0 where they are on one line.
int side_of_line(const Vec2& a, const Vec2& b, const Vec2& c) noexcept;

// Error bound of a determinant of three differences of points, computed in double precision in any order, without or
// with fused multiply-adds. With u = 2^-53: each of its six products of one x, one y and one z has three differences
// rounded (3), two multiplications (2) and takes part in at most three additions (3), so the error is below ((1 + u)^8
// - 1) times the sum of the products' magnitudes. That is at most 6 ex ey ez where no difference is larger than those
// extents: 48.1 u ex ey ez, of which we allow 64 u: room for the extents' own rounding and that of this product.
// Nothing underflows (exact_orientation.cpp).
constexpr double determinant_error(double extent_x, double extent_y, double extent_z) {
  return 0x1p-47 * extent_x * extent_y * extent_z;
}

}  // namespace spherechain
