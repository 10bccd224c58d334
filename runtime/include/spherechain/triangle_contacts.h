// SPDX-License-Identifier: MIT
#pragma once

#include "spherechain/abi.h"
#include "spherechain/types.h"

namespace spherechain {

// Do two triangles have a point in common? Exactly, for all finite floats: touching counts, and so does overlap in one
// plane. A degenerate triangle, its corners on one line, intersects nothing; neither does one that is not finite. Needs
// the processor's default rounding, to nearest; where it takes subnormal floats as zero, so does this.
SPHERECHAIN_API bool triangles_intersect(const Vec3 (&a)[3], const Vec3 (&b)[3]) noexcept;

// What two triangles have in common, rounded.
struct TriangleOverlap {
  Vec3 from, to;  // the segment; of triangles in one plane the longest piece of an edge that lies in the other triangle
  Vec3 normal;    // unit length, of one of the two planes
  float depth;    // moving b so far along the normal parts the two: the least of such moves along the two normals; >= 0
};

// Of triangles that intersect.
SPHERECHAIN_API TriangleOverlap overlap_triangles(const Vec3 (&a)[3], const Vec3 (&b)[3]) noexcept;

}  // namespace spherechain
