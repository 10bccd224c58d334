// SPDX-License-Identifier: MIT
// Which pairs of a tile are looked at, by rows: what asset and filter leave of them, whatever the spheres are.
#pragma once

#include <cstddef>
#include <cstdint>

#include "asset/asset_view.h"
#include "pairs/listed_pairs.h"
#include "pairs/overlap.h"
#include "spherechain/detect.h"

namespace spherechain {

// What an asset and a filter leave out.
struct PairChoice {
  Span<const std::uint64_t> ignored;   // in the order of AssetView::ignored()
  Span<const std::uint64_t> disabled;  // may be empty
  Span<const RestPair> rest_pairs;
};

// Fills rows [0, padded_rows(place.row_count)).
void fill_rows(Target resolved, const PairChoice& choice, const TilePlace& place, TileWords* wanted, TileWords* plain);

// Those of a detect table. No default values: setting them would be a good part of a job.
struct PairRows {
  const TileWords *wanted, *plain;
  PairLists lists;
};

// A detect table's content.
struct DetectTable {
  std::size_t size = 0;  // words
  Span<const float> padding;
  bool has_rows = false;  // of an asset of one tile; else what its filter leaves out
  PairRows rows;
  Span<const std::uint64_t> ignored, disabled;
};

// SC_MISALIGNED, or SC_BAD_VALUE where it was not prepared for this.
Status read_detect_table(const AssetView& asset, Radius radius, const std::uint64_t* words, DetectTable& out);

}  // namespace spherechain
