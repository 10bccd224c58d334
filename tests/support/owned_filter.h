// SPDX-License-Identifier: MIT
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "runtime/src/base/filter.h"
#include "runtime/src/base/pair_bits.h"
#include "spherechain/asset.h"

namespace spherechain::test {

// A copy of an asset's ignored pairs.
inline std::vector<std::uint64_t> ignored_pairs_of(const Asset& asset) {
  const std::uint64_t* const own = sc_asset_get_info(&asset).ignored_pairs;
  return {own, own + sc_pair_words(&asset)};
}

// Sets or clears the bit of a pair of different spheres.
inline void ignore_pair(std::vector<std::uint64_t>& ignored, std::uint32_t a, std::uint32_t b, bool is_ignored = true) {
  assign_bit({ignored.data(), ignored.size()}, ignored_bit(std::min(a, b), std::max(a, b)), is_ignored);
}

// A filter with memory of its own, set to the asset's.
struct OwnedFilter {
  explicit OwnedFilter(const Asset& asset) : ignored(ignored_pairs_of(asset)), filter{ignored.data(), ignored.size()} {}
  OwnedFilter(const OwnedFilter&) = delete;
  OwnedFilter& operator=(const OwnedFilter&) = delete;

  void ignore(std::uint32_t a, std::uint32_t b, bool is_ignored = true) { ignore_pair(ignored, a, b, is_ignored); }

  std::vector<std::uint64_t> ignored;
  Filter filter;
};

}  // namespace spherechain::test
