// SPDX-License-Identifier: MIT
// Leaves for a synthetic asset: what the runtime bounds and finds exact contacts in.
#pragma once

#include "tiny_bones.h"

namespace spherechain::test {

// Cuts each sphere's triangles into leaves of at most `triangles_of_leaf`, and lists one contact at rest. `skin` is
// null for an asset without bones.
void add_surface(TinyAsset& tiny, const TinySkin* skin, std::size_t triangles_of_leaf);

}  // namespace spherechain::test
