// SPDX-License-Identifier: MIT
// Triangles that other pieces of the skin hide at rest: a body below a suit, teeth, the lining of a coat. From their
// fronts every look ends at another piece. One of every eight triangles of a cluster that follow one another is looked
// from.
#pragma once

#include "runtime/src/skin/skin_table.h"

namespace spherechain {

// A byte a triangle, kept behind the parts of the triangles.
inline std::size_t bytes_of_parts(std::size_t triangle_count) { return 2 * triangle_count; }
inline bool is_covered(const Surface& surface, std::size_t triangle) {
  return surface.parts.data[surface.parts.size + triangle] != 0;
}

// From a filled table: clusters, boxes, triangles' vertices and pieces.
void find_covered(const Surface& surface);

}  // namespace spherechain
