// SPDX-License-Identifier: MIT
// The pairs of spheres that a job leaves out.
#pragma once

#include <cstddef>
#include <cstdint>

namespace spherechain {

// A caller's bits, laid out as sc_asset_info.ignored_pairs.
struct Filter {
  const std::uint64_t* ignored = nullptr;
  std::size_t ignored_words = 0;
};

}  // namespace spherechain
