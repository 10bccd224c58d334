// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "runtime/src/skin/skin_table.h"

namespace spherechain::baker {

// Clusters and what lies over them.
struct Stack {
  std::vector<char> is_buried;
  std::vector<Pair> pairs;
};

// `surface` knows what is covered, and its facings; `rest_contacts` are places of triangles in it.
Stack find_stack(const AssetView& asset, const Surface& surface, const std::vector<Pair>& rest_contacts);

}  // namespace spherechain::baker
