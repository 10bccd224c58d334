// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>
#include <stdexcept>

#include "contact_finder.h"
#include "runtime/src/base/pair_bits.h"
#include "runtime/src/contacts/contact_jobs.h"

namespace spherechain::bench {

ContactMesh::ContactMesh(const PosedCharacter& character)
    : character(character), skin_table(memory_for(skin_table_words(&character.asset))) {
  std::uint64_t* const words = skin_table.data()->words;
  if (prepare_skin(&character.asset, words, skin_table_words(&character.asset)) != SC_OK ||
      read_skin_table(character.view(), words, surface) != SC_OK) {
    throw std::runtime_error("the asset's skin cannot be prepared");
  }
  std::map<std::uint32_t, std::uint32_t> number_of_weld;
  for (const Cluster& cluster : surface.clusters) {
    for (std::uint32_t i = 0; i < cluster.triangle_count; ++i) {
      const std::size_t triangle = std::size_t{cluster.first_triangle} + i;
      source_triangles.push_back(surface.triangles[triangle]);
      spheres.push_back(cluster.sphere);
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t vertex = surface.cluster_vertices[cluster.first_vertex + surface.corners[3 * triangle + k]];
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
  if (low == high || test_bit(character.view().ignored(), ignored_bit(low, high))) {
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
