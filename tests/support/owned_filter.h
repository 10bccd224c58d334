// SPDX-License-Identifier: MIT
#pragma once

#include <doctest/doctest.h>

#include <cstdint>
#include <vector>

#include "spherechain/detect.h"

namespace spherechain::test {

// A filter with memory of its own, set to the asset's from whatever was in it before.
struct OwnedFilter {
  explicit OwnedFilter(const Asset& asset)
      : ignored(sc_pair_words(&asset), ~std::uint64_t{0}),
        disabled(sc_sphere_words(&asset), ~std::uint64_t{0}),
        padding(sc_asset_get_info(&asset).sphere_count, 99.0F),
        filter{ignored.data(), ignored.size(), disabled.data(), disabled.size(), padding.data(), padding.size()} {
    REQUIRE(sc_reset_filter(&asset, &filter) == SC_OK);
  }
  OwnedFilter(const OwnedFilter&) = delete;
  OwnedFilter& operator=(const OwnedFilter&) = delete;

  std::vector<std::uint64_t> ignored, disabled;
  std::vector<float> padding;
  Filter filter;
};

}  // namespace spherechain::test
