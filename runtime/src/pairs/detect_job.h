// SPDX-License-Identifier: MIT
// Which spheres touch?
#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/src/base/filter.h"
#include "spherechain/asset.h"

namespace spherechain {

// The overlap test of all pairs of spheres that are not ignored. Rest pairs, most of which touch at rest, are reported
// where they come closer than rest_scale times the sum of their radii (docs/arithmetic.md). It needs 25 KiB of stack.
struct DetectJob {
  const Asset* asset = nullptr;  // open
  const Sphere* spheres = nullptr;
  std::size_t sphere_count = 0;  // at least the asset's
  Radius radius{};               // of the spheres: which refit made them
  Target target{};
  // At most one of the two. A table from prepare_detect(), with this asset and radius, is faster and holds the filter
  // it was made with. Without both the asset's own ignored pairs are left out.
  const std::uint64_t* table = nullptr;
  const Filter* filter = nullptr;
  Pair* pairs = nullptr;  // out: sorted, each once; null: count only
  std::size_t pair_capacity = 0;
  std::uint64_t* bits =
      nullptr;  // out: bit b(b-1)/2 + a of each pair; sc_pair_words() words exactly; or null. Cheapest
  std::size_t bit_words = 0;
  std::size_t pair_count = 0;  // out: how many there are, also where `pairs` is too small

  // SC_OK; SC_OVERFLOW: the first pairs are written; after another error nothing is.
  Status run() noexcept;
};

// Fills a table for detect jobs with this asset and radius, and with all that `filter` (or null) says now. It halves
// the time of a detection; any number of jobs may share it. `words` has detect_table_words() words, 0 where the asset
// is not open.
std::size_t detect_table_words(const Asset* asset) noexcept;
Status prepare_detect(const Asset* asset, Radius radius, const Filter* filter, std::uint64_t* words,
                      std::size_t word_count) noexcept;

}  // namespace spherechain
