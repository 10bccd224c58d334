// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "spherechain/types.h"

namespace spherechain::baker {

// The triangles, of whatever spheres, that intersect in the rest pose and share no corner there; sorted. `asset` is one
// without this list yet, `rest` its source's positions. Throws Error(kInternal).
std::vector<Pair> find_rest_contacts(const std::vector<std::uint8_t>& asset, const std::vector<float>& rest);

}  // namespace spherechain::baker
