// SPDX-License-Identifier: MIT
// The spheres and tables that a detect job looks at.
#pragma once

#include "runtime/src/pairs/pair_lists.h"

namespace spherechain {

// No default values for `lists`: setting them would be a good part of a job.
struct SpheresToPair {
  Span<const Sphere> spheres;
  PairChoice choice;
  std::size_t table_words = 0;  // 0: no table
  bool has_lists = false;       // of a table: `lists` are those of the only tile, in place of `choice`
  PairLists lists;
};

// SC_MISALIGNED, or SC_BAD_VALUE where the table was not prepared for this. Fills all but the spheres.
Status read_detect_table(const AssetView& asset, Radius radius, const std::uint64_t* words, SpheresToPair& set);

}  // namespace spherechain
