// SPDX-License-Identifier: MIT
// Do two triangles meet, and where.
#pragma once

#include "spherechain/types.h"

namespace spherechain {

struct TriangleCorners {
  Vec3 p[3];
};

// A triangle that is this much smaller than its greatest coordinate is a point: roundings decide its shape.
inline constexpr float kPointSize = 0x1p-20F;
bool is_point(const TriangleCorners& t) noexcept;

// Do two triangles have a point in common? Exactly, for all finite floats: touching counts, and so does overlap in one
// plane. A degenerate triangle, its corners on one line, intersects nothing; neither does one that is a point but for
// rounding, or not finite. Needs the processor's default rounding, to nearest; where it takes subnormal floats as zero,
// so does this.
bool triangles_intersect(const TriangleCorners& a, const TriangleCorners& b) noexcept;

struct Segment {
  Vec3 from, to;
};

// The segment in which two intersecting triangles cross. If they lie in one plane: the longest piece of an edge that
// lies in the other triangle.
Segment crossing_segment(const TriangleCorners& a, const TriangleCorners& b) noexcept;

}  // namespace spherechain
