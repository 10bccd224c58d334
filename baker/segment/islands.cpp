// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/segment/islands.h"

namespace spherechain::baker {

Islands find_islands(const Mesh& mesh, const Neighbours& neighbours, const std::vector<std::uint8_t>& labels) {
  Islands islands{std::vector<Index>(labels.size(), kNoIndex), {}, {}};
  for (Index seed = 0; seed < labels.size(); ++seed) {
    if (islands.of_triangle[seed] != kNoIndex) continue;
    const auto id = static_cast<Index>(islands.triangles.size());
    islands.of_triangle[seed] = id;
    std::vector<Index> triangles{seed};
    double area = 0;
    for (std::size_t head = 0; head < triangles.size(); ++head) {
      area += triangle_area(mesh, triangles[head]);
      for (const Index n : neighbours[triangles[head]]) {
        if (n == kNoIndex || islands.of_triangle[n] != kNoIndex || labels[n] != labels[seed]) continue;
        islands.of_triangle[n] = id;
        triangles.push_back(n);
      }
    }
    islands.triangles.push_back(std::move(triangles));
    islands.area.push_back(area);
  }
  return islands;
}

std::array<double, 256> border_lengths(const Mesh& mesh, const Neighbours& neighbours, const Islands& islands,
                                       const std::vector<std::uint8_t>& labels, Index island) {
  std::array<double, 256> border{};
  for (const Index t : islands.triangles[island]) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Index n = neighbours[t][k];
      if (n == kNoIndex || islands.of_triangle[n] == island) continue;
      const Triangle& corners = mesh.triangles[t];
      border[labels[n]] += (mesh.positions[corners[k]] - mesh.positions[corners[(k + 1) % 3]]).norm();
    }
  }
  return border;
}

}  // namespace spherechain::baker
