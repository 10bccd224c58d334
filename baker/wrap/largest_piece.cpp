// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/wrap/largest_piece.h"

#include <algorithm>

namespace spherechain::baker {

LargestPiece largest_piece(const Mesh& mesh) {
  const Components components = connected_components(mesh);
  std::vector<double> area(components.count, 0.0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) area[components.of_triangle[t]] += triangle_area(mesh, t);
  const auto largest = static_cast<Index>(std::max_element(area.begin(), area.end()) - area.begin());
  LargestPiece piece;
  std::vector<Index> place(mesh.positions.size(), kNoIndex);
  for (Index t = 0; t < mesh.triangles.size(); ++t) {
    if (components.of_triangle[t] != largest) continue;
    Triangle corners = mesh.triangles[t];
    for (Index& v : corners) {
      if (place[v] == kNoIndex) {
        place[v] = static_cast<Index>(piece.mesh.positions.size());
        piece.mesh.positions.push_back(mesh.positions[v]);
        piece.of_vertex.push_back(v);
      }
      v = place[v];
    }
    piece.mesh.triangles.push_back(corners);
    piece.of_triangle.push_back(t);
  }
  return piece;
}

}  // namespace spherechain::baker
