// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "baker/import/import.h"

namespace spherechain::baker {

// A primitive of a glTF as the scene shows it: a run of the source's triangles. A mesh that two nodes show has two
// runs.
struct PrimitiveRun {
  std::size_t mesh, primitive;  // the glTF's numbers
  Index first, count;           // triangles
};

// The runs of a character in `gltf`, which read_as_glb() made of its file. Throws Error(kFile) where they do not agree.
std::vector<PrimitiveRun> primitive_runs(const Character& character, const nlohmann::ordered_json& gltf);

// A run has the name of its mesh, or of its material where the mesh has several primitives.
std::string run_name(const PrimitiveRun& run, const nlohmann::ordered_json& gltf);

// A character's triangles at rest, as they are drawn and as they hang together. Triangles have the source's numbers.
struct LayeredSkin {
  Mesh rest;                 // the source's vertices and triangles
  Mesh welded;               // the same triangles on vertices that are joined where they are at one position
  std::vector<Index> piece;  // of each triangle: a connected piece
  Index piece_count = 0;
  std::vector<Index> run;          // of each triangle: its primitive as the scene shows it
  std::vector<char> is_opaque;     // the triangle covers what is behind it
  std::vector<char> is_two_sided;  // the triangle is drawn from behind, too
  Vec3 up;
  double height;
};

LayeredSkin make_layered_skin(const Character& character, const std::vector<PrimitiveRun>& runs,
                              const nlohmann::ordered_json& gltf);

}  // namespace spherechain::baker
