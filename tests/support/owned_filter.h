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
      : ignored(Filter::ignored_words(asset), ~std::uint64_t{0}),
        disabled(Filter::disabled_words(asset), ~std::uint64_t{0}),
        padding(asset.spheres().size, 99.0F),
        filter{{ignored.data(), ignored.size()}, {disabled.data(), disabled.size()}, {padding.data(), padding.size()}} {
    REQUIRE(reset_filter(asset, filter) == Status::kOk);
  }
  OwnedFilter(const OwnedFilter&) = delete;
  OwnedFilter& operator=(const OwnedFilter&) = delete;

  std::vector<std::uint64_t> ignored, disabled;
  std::vector<float> padding;
  Filter filter;
};

}  // namespace spherechain::test
