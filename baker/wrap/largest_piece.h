// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// The connected piece of a mesh with the largest area.
struct LargestPiece {
  Mesh mesh;
  std::vector<Index> of_vertex, of_triangle;  // its vertex or triangle -> the mesh's
};

LargestPiece largest_piece(const Mesh& mesh);

}  // namespace spherechain::baker
