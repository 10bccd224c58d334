// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/import/import.h"
#include "baker/play/asset_file.h"
#include "spherechain/types.h"

namespace spherechain::baker {

// The triangles an asset's spheres own, in the order of their source numbers, whatever the asset's order.
struct TruthSurface {
  std::vector<Index> source_triangle;         // ascending
  std::vector<Triangle> corners;              // source vertices
  std::vector<Triangle> welded;               // the same corners as vertices of Character::skin
  std::vector<std::uint32_t> sphere;          // that owns it
  std::vector<Index> of_source;               // source triangle -> its place above, kNoIndex where no sphere owns it
  std::vector<std::vector<Index>> of_sphere;  // a sphere's triangles, by their place above
};

// Throws Error(kInternal) where the asset's triangles are not some of the character's.
TruthSurface surface_of(const OpenAsset& asset, const Character& character);

// True if two triangles share a corner at rest: neighbours on the mesh, never a contact.
bool are_neighbours(const Triangle& a, const Triangle& b);

// True if the asset never reports a pair of spheres.
bool is_ignored(const OpenAsset& asset, std::uint32_t a, std::uint32_t b);

}  // namespace spherechain::baker
