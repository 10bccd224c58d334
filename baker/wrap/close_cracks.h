// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// A mesh without cracks: border vertices that are very close are welded, and border triangles are split where a border
// vertex of another triangle lies on their edge.
struct Uncracked {
  Mesh mesh;                       // vertices as they were, not all in use
  std::vector<Index> of_triangle;  // a triangle -> the original's
  std::vector<Index> welded_to;    // an original vertex -> the vertex that replaces it, mostly itself
  std::size_t welded = 0;          // vertices that were replaced
  std::size_t t_junctions = 0;     // border vertices that an edge was split at
};

// `tolerance` is in the mesh's units. Vertices inside a surface never move, so that fingers that touch stay apart.
Uncracked close_cracks(const Mesh& mesh, double tolerance);

}  // namespace spherechain::baker
