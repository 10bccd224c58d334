// SPDX-License-Identifier: MIT
// The packed skin of a synthetic asset: what the runtime bounds and finds exact contacts in.
#pragma once

#include "tiny_bones.h"

namespace spherechain::test {

// Cuts each sphere's triangles into clusters of at most that many (64 are allowed), and packs them. Two contacts at
// rest are listed. `skin` is null for an asset without bones.
void add_skin(TinyAsset& tiny, const TinySkin* skin, std::size_t triangles_of_cluster);

}  // namespace spherechain::test
