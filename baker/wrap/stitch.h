// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// A mesh whose pieces are surfaces: no edge has more than two triangles, neighbours face the same way, and every hole
// is closed by a fan around its middle.
struct Stitched {
  Mesh mesh;
  std::vector<Index> of_triangle;  // a triangle -> the original's, kNoIndex where it closes a hole
  std::vector<Index> of_vertex;    // a vertex -> the original's, kNoIndex in the middle of a hole
  std::size_t turned = 0;          // triangles that faced the other way than those around them
  std::size_t parted = 0;          // edges of more than two triangles, at which the surfaces were taken apart
  std::size_t holes = 0;           // closed
};

Stitched stitch(const Mesh& mesh);

}  // namespace spherechain::baker
