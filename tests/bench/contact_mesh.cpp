// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>

#include "contact_finder.h"

namespace spherechain::bench {

ContactMesh::ContactMesh(const PosedCharacter& character) : character(character) {
  const baker::Character& source = character.bake.character;
  std::map<std::uint32_t, std::uint32_t> weld_of_skin;
  const auto owned = character.asset.spheres();
  for (std::uint32_t sphere = 0; sphere < owned.size; ++sphere) {
    for (std::uint32_t i = 0; i < owned[sphere].triangle_count; ++i) {
      const std::uint32_t triangle = character.asset.triangles()[owned[sphere].first_triangle + i];
      source_triangles.push_back(triangle);
      spheres.push_back(sphere);
      for (const std::uint32_t vertex : source.source_triangles[triangle]) {
        corners.push_back(vertex);
        const auto [at, is_new] =
            weld_of_skin.try_emplace(source.skin_of_source[vertex], static_cast<std::uint32_t>(vertices.size()));
        if (is_new) {
          vertices.push_back(vertex);
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
