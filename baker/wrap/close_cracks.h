// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "mesh/mesh.h"

namespace spherechain::baker {

// A mesh whose border vertices are welded where they all but coincide, and whose border triangles are split where a
// border vertex of others lies on their edge.
struct Uncracked {
  Mesh mesh;                       // vertices as they were, not all in use
  std::vector<Index> of_triangle;  // a triangle -> the original's
  std::vector<Index> welded_to;    // an original vertex -> the one that took its place, itself where none did
  std::size_t welded = 0;          // vertices that another took the place of
  std::size_t t_junctions = 0;     // border vertices that an edge was split at
};

// `tolerance` in the mesh's units. Vertices inside a surface never move: fingers that touch stay two.
Uncracked close_cracks(const Mesh& mesh, double tolerance);

}  // namespace spherechain::baker
