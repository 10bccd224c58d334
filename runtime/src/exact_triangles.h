// SPDX-License-Identifier: MIT
// Do two triangles meet, and where.
#pragma once

#include "spherechain/triangle_contacts.h"
#include "spherechain/types.h"

namespace spherechain {

struct TriangleCorners {
  Vec3 p[3];
};

// As triangles_intersect(), of corners known to be finite.
bool finite_triangles_intersect(const TriangleCorners& a, const TriangleCorners& b) noexcept;

// Of two triangles that intersect.
TriangleOverlap overlap_of(const TriangleCorners& a, const TriangleCorners& b) noexcept;

}  // namespace spherechain
