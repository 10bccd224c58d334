// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace spherechain::baker {

struct Character;

// Skin that hangs together. Pieces are numbered by their lowest vertices.
struct SkinPiece {
  std::string name;   // of the node, the mesh and the material that most of it has in the source
  double border = 0;  // length of its edges at rest that one triangle has: hems, hair cards; 0 where it is closed
};

// How a skin lies over itself at rest. Triangles and clusters are in the asset's order; empty lists say that nothing is
// known yet.
struct Layers {
  using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  // The piece over a cluster that most looks from there meet. The distance is their median.
  struct Cover {
    std::uint32_t piece = 0;  // 1 more than its number; 0: nothing lies over the cluster
    float distance = 0;
  };
  std::vector<SkinPiece> pieces;
  std::vector<Cover> covers;              // of each cluster
  Pairs rest_contacts;                    // the source's triangles that intersect and share no corner; sorted
  std::vector<std::uint8_t> of_triangle;  // bits: see schemas/sphere_chains.fbs, Skin.layer_runs
  std::vector<char> is_buried;            // a cluster's: other pieces lie closely over it, and move with it
  Pairs pairs;                            // of clusters that lie over each other; sorted
  std::vector<std::int8_t> windings;      // around the spheres' centres: three each
  std::vector<std::uint32_t> core_triangles;
  std::vector<std::int8_t> core_windings;
};

// `draft` is the character's asset, without layers yet. Throws Error(kInternal).
Layers find_layers(const std::vector<std::uint8_t>& draft, const Character& character);

}  // namespace spherechain::baker
