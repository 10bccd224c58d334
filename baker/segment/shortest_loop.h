// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh/mesh.h"

namespace spherechain::baker {

// Where a triangle of a strip around a cut may end up.
enum class Strip : std::uint8_t { kOutside, kFree };

// Relabels the strip's free triangles so that the edges between `inner` and all other labels are as short as possible
// in sum: a plane cuts through triangles and leaves teeth, the shortest loop has none. (A minimum cut of the dual
// graph; of several the one with the smallest inner side.) Free triangles that do not become `inner` become `outer`.
void shorten_loop(const Mesh& mesh, const std::vector<std::array<Index, 3>>& neighbours,
                  const std::vector<Strip>& strip, std::uint8_t inner, std::uint8_t outer,
                  std::vector<std::uint8_t>& labels);

}  // namespace spherechain::baker
