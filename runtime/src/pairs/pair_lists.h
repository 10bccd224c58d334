// SPDX-License-Identifier: MIT
// Which pairs of a tile are tested: what asset and filter leave of them, whatever the spheres are.
#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/src/asset/asset_view.h"
#include "runtime/src/base/filter.h"
#include "runtime/src/pairs/tile.h"

namespace spherechain {

// The pairs of spheres that an asset and a filter leave out, and those that touch at rest.
struct PairChoice {
  Span<const RestPair> rest_pairs;
  Span<const std::uint64_t> ignored;  // in the order of AssetView::ignored()
};

// `filter` may be null.
inline PairChoice choice_of(const AssetView& asset, Radius radius, const Filter* filter) {
  if (filter == nullptr) {
    return {asset.rest_pairs(radius), asset.ignored()};
  }
  return {asset.rest_pairs(radius), {filter->ignored, filter->ignored_words}};
}

// How many strips a tile has whose rows are its columns; and up to a whole group.
constexpr std::size_t strips_of(std::size_t sphere_count) {
  const std::size_t blocks = sphere_count < 2 ? 0 : (sphere_count - 1 + kBlock - 1) / kBlock;
  return blocks == 0 ? 0 : blocks * (sphere_count - 1) - blocks * (blocks - 1) / 2 * kBlock;
}
constexpr std::size_t padded_strips(std::size_t sphere_count) {
  return (strips_of(sphere_count) + kStripGroup - 1) / kStripGroup * kStripGroup;
}

// Memory for PairLists.
struct PairListBuffers {
  std::uint16_t* wanted;
  ListedPair *strips, *rest_pairs;
  float* rest_scales;
  std::size_t rest_room;  // a multiple of kBlock
};

// Fills `wanted`, with rest pairs, and `strips`. Returns how many strips there are.
std::size_t fill_strips(Target resolved, const PairChoice& choice, const TilePlace& place,
                        const PairListBuffers& buffers);

// Moves rest pairs, those of the tile's columns, out of `wanted` to the list of rest pairs, as long as it has room.
// Returns how long the list is, and leaves in `rest_pairs` those it has not come to.
std::size_t move_rest_pairs(Span<const RestPair>& rest_pairs, const TilePlace& place, const PairListBuffers& buffers);

}  // namespace spherechain
