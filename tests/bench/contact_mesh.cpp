// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>

#include "contact_finder.h"

namespace spherechain::bench {

ContactMesh::ContactMesh(const PosedCharacter& character) : character(character) {
  const Surface& surface = character.asset.surface();
  std::map<std::uint32_t, std::uint32_t> number_of_weld;
  for (const Leaf& leaf : surface.leaves) {
    for (std::uint32_t i = 0; i < leaf.triangle_count; ++i) {
      const std::size_t triangle = std::size_t{leaf.first_triangle} + i;
      source_triangles.push_back(character.asset.triangles()[triangle]);
      spheres.push_back(leaf.sphere);
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t vertex = surface.leaf_vertices[leaf.first_vertex + surface.corners[3 * triangle + k]];
        corners.push_back(surface.source_vertices[vertex]);
        const auto [at, is_new] =
            number_of_weld.try_emplace(surface.welds[vertex], static_cast<std::uint32_t>(vertices.size()));
        if (is_new) {
          vertices.push_back(surface.source_vertices[vertex]);
        }
        welds.push_back(at->second);
      }
    }
  }
}

bool ContactMesh::is_wanted(std::uint32_t a, std::uint32_t b) const {
  const std::size_t low = std::min(spheres[a], spheres[b]), high = std::max(spheres[a], spheres[b]);
  if (low == high) {
    return false;
  }
  const std::size_t bit = high * (high - 1) / 2 + low;
  if (((character.asset.ignored()[bit / 64] >> (bit % 64)) & 1U) != 0) {
    return false;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (welds[3 * a + i] == welds[3 * b + j]) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace spherechain::bench
