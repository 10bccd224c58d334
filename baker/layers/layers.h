// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

namespace spherechain::baker {

// How a skin lies over itself at rest. A piece is skin that hangs together. Triangles and clusters are in the asset's
// order; empty lists say that nothing is known yet.
struct Layers {
  using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  Pairs rest_contacts;                    // the source's triangles that intersect and share no corner; sorted
  std::vector<std::uint8_t> of_triangle;  // bits: see schemas/sphere_chains.fbs, Skin.layer_runs
  std::vector<char> is_buried;            // a cluster's: other pieces lie closely over it, and move with it
  Pairs pairs;                            // of clusters that lie over each other; sorted
  std::vector<std::int8_t> windings;      // around the spheres' centres: three each
  std::vector<std::uint32_t> core_triangles;
  std::vector<std::int8_t> core_windings;
};

// `draft` is an asset whose layers are not known yet, `rest` its source's positions. Throws Error(kInternal).
Layers find_layers(const std::vector<std::uint8_t>& draft, const std::vector<float>& rest);

}  // namespace spherechain::baker
