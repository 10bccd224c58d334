// SPDX-License-Identifier: MIT
// Triangle pairs that never count as contacts: neighbours on the skin, pairs that intersect at rest, and parts that the
// caller ignores; and those that count only where layers of one place are asked for.
#pragma once

#include <algorithm>
#include <cstddef>

#include "runtime/src/skin/skin_table.h"

namespace spherechain {

// The skin of one body, with the parts that its caller excludes from every contact.
struct FilteredSkin {
  const Surface* surface;
  const std::uint64_t* ignored_parts;  // one bit per body part; null: none is ignored

  bool ignores(std::size_t triangle) const {
    const std::size_t part = surface->parts[triangle];
    return ignored_parts != nullptr && (ignored_parts[part / 64] >> part % 64 & 1) != 0;
  }
};

// Locates a triangle in the baked tables, not in the source's numbering: indices into Surface::clusters and
// Surface::triangles.
struct PlacedTriangle {
  std::size_t cluster, triangle;
};

// True if two triangles of one body share a corner position in the rest pose, which makes them neighbours.
inline bool share_a_position(const Surface& surface, const PlacedTriangle& a, const PlacedTriangle& b) {
  const auto weld = [&](const PlacedTriangle& of, std::size_t corner) {
    const std::size_t place = surface.corners[3 * of.triangle + corner];
    return surface.welds[surface.cluster_vertices[surface.clusters[of.cluster].first_vertex + place]];
  };
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t own = weld(a, i);
    for (std::size_t j = 0; j < 3; ++j) {
      if (own == weld(b, j)) {
        return true;
      }
    }
  }
  return false;
}

inline bool is_buried(const Surface& surface, std::size_t cluster) {
  return (surface.buried[cluster / 64] >> cluster % 64 & 1) != 0;
}

// True if the one cluster lies over the other.
inline bool are_layers(const Surface& surface, std::size_t cluster, std::size_t other) {
  for (std::uint32_t i = surface.first_of_layers[cluster]; i < surface.first_of_layers[cluster + 1]; ++i) {
    if (surface.layer_words[i] == other / 64) {
      return (surface.layer_bits[i] >> other % 64 & 1) != 0;
    }
  }
  return false;
}

// True if two triangles of one body intersect in the rest pose. Pass the source's numbers, the lower one first.
inline bool intersect_at_rest(const Surface& surface, const Pair& triangles) {
  return std::binary_search(surface.rest_contacts.begin(), surface.rest_contacts.end(), triangles);
}

}  // namespace spherechain
