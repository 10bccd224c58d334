// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// Relabels a strip of triangles around a cut so that the edges between `inner` and all other labels are as short as
// possible in sum: a plane cuts through triangles and leaves teeth, the shortest loop has none. (A minimum cut of the
// dual graph; of several the one with the smallest inner side.) Those that do not become `inner` become `outer`.
void shorten_loop(const Mesh& mesh, const std::vector<std::array<Index, 3>>& neighbours,
                  const std::vector<Index>& strip, std::uint8_t inner, std::uint8_t outer,
                  std::vector<std::uint8_t>& labels);

}  // namespace spherechain::baker
