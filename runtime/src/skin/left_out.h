// SPDX-License-Identifier: MIT
// Pairs of triangles that are no contacts, whatever they do.
#pragma once

#include <algorithm>
#include <cstddef>

#include "skin/skin_table.h"

namespace spherechain {

// A body's triangles; a bit for each part that meets nothing, or null.
struct Skin {
  const Surface* surface;
  const std::uint64_t* ignored_parts;

  bool ignores(std::size_t triangle) const {
    const std::size_t part = surface->parts[triangle];
    return ignored_parts != nullptr && (ignored_parts[part / 64] >> part % 64 & 1) != 0;
  }
};

// By places: of a cluster, and of a triangle in Surface::triangles.
struct PlacedTriangle {
  std::size_t cluster, triangle;
};

// Have two triangles of one body a corner each at the same position at rest?
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

// Do two triangles of one body intersect at rest? By the source's numbers, the lower one first.
inline bool intersect_at_rest(const Surface& surface, const Pair& triangles) {
  return std::binary_search(surface.rest_contacts.begin(), surface.rest_contacts.end(), triangles);
}

}  // namespace spherechain
