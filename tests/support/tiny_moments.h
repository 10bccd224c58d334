// SPDX-License-Identifier: MIT
// The tables of refit by moments for a synthetic asset.
#pragma once

#include <cstddef>

#include "tiny_bones.h"

namespace spherechain::test {

enum class PivotTables { kLeftOut, kKept };  // kept: as in assets of older bakers

// Makes refit by moments the rule of an asset that add_bones has given that skin: pivot spreads are root mean squares,
// no morph target moves anything any more, and batches are filled up to that many pairs. No sphere may hang on more
// than kMaxMomentBones.
void add_moments(TinyAsset& tiny, TinySkin& skin, std::size_t batch_pairs = 48,
                 PivotTables pivots = PivotTables::kLeftOut);

}  // namespace spherechain::test
