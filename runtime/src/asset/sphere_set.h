// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>

#include "asset/asset_view.h"

namespace spherechain {

// Which spheres have been seen. 8 KiB: on the stack of one check at a time.
class SphereSet {
 public:
  bool insert(std::uint32_t sphere) {
    std::uint64_t& word = words_[sphere / 64];
    const std::uint64_t bit = std::uint64_t{1} << (sphere % 64);
    const bool is_new = (word & bit) == 0;
    word |= bit;
    return is_new;
  }
  void erase(std::uint32_t sphere) { words_[sphere / 64] &= ~(std::uint64_t{1} << (sphere % 64)); }

 private:
  std::uint64_t words_[kMaxSphereCount / 64 + 1] = {};
};

}  // namespace spherechain
