// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/import/import.h"
#include "baker/layers/layers.h"
#include "runtime/src/skin/skin_table.h"

namespace spherechain::baker {

// The piece of each of the surface's vertices.
std::vector<std::uint32_t> number_pieces(const Surface& surface);

// The pieces of a character whose surface this is.
std::vector<SkinPiece> find_pieces(const Surface& surface, const Character& character);

}  // namespace spherechain::baker
