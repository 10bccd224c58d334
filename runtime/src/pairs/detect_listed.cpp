// SPDX-License-Identifier: MIT
// All pairs with a detect table, where few pairs touch: they come as a list.
#include "pairs/detect_steps.h"
#include "simd/arithmetic.h"

namespace spherechain {

bool detect_listed(const Scene& scene, Result& result) {
  Sphere padded[kTileSize];
  FoundPairs found;
  if (!find_listed(scene.target, scene.block(0, scene.size(), padded), scene.size(), scene.rows->lists, found)) {
    return false;
  }
  result.pairs.count = found.count;
  if (result.bits.size > 0) {
    for (std::size_t i = 0; i < found.count; ++i) {
      set_bit(result.bits, ignored_bit(found.pairs[i].a / sizeof(Sphere), found.pairs[i].b / sizeof(Sphere)));
    }
  }
  if (result.pairs.buffer.size > 0) {
    list_in_order(scene.target, found, result.pairs.buffer);
  }
  return true;
}

}  // namespace spherechain
