// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/layers/layers.h"
#include "runtime/src/skin/skin_table.h"

namespace spherechain::baker {

// Clusters and what lies over them.
struct Stack {
  std::vector<Layers::Cover> covers;
  std::vector<char> is_buried;
  Layers::Pairs pairs;
};

// `surface` knows what is covered, and its facings; `rest_contacts` are places of triangles in it.
Stack find_stack(const AssetView& asset, const Surface& surface, const Layers::Pairs& rest_contacts);

}  // namespace spherechain::baker
