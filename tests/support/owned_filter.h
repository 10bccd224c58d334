// SPDX-License-Identifier: MIT
#pragma once

#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

#include "spherechain/filter.h"

namespace spherechain::test {

// A filter with memory of its own, set to the asset's from whatever was in it before.
struct OwnedFilter {
  explicit OwnedFilter(const Asset& asset)
      : ignored(sc_pair_words(&asset), ~std::uint64_t{0}), filter{ignored.data(), ignored.size()} {
    REQUIRE(sc_reset_filter(&asset, &filter) == SC_OK);
  }
  OwnedFilter(const OwnedFilter&) = delete;
  OwnedFilter& operator=(const OwnedFilter&) = delete;

  std::vector<std::uint64_t> ignored;
  Filter filter;
};

}  // namespace spherechain::test
