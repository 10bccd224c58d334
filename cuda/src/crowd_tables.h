// SPDX-License-Identifier: MIT
// The parts that prepare_crowd() puts together.
#pragma once

#include <algorithm>

#include "crowd_view.h"
#include "runtime/src/asset/asset_view.h"

namespace spherechain::cuda {

// Arrays one after another in the caller's memory, zero where nothing is written; without memory their size alone.
class TableMemory {
 public:
  explicit TableMemory(std::uint64_t* words) : words_(words) {}

  bool is_null() const { return words_ == nullptr; }
  std::size_t used() const { return used_; }  // words

  template <typename T>
  T* take(std::size_t count, std::uint32_t& at) {
    at = static_cast<std::uint32_t>(used_);
    used_ += (count * sizeof(T) + 15) / 16 * 2;
    if (is_null()) {
      return nullptr;
    }
    std::fill(words_ + at, words_ + used_, std::uint64_t{0});
    return reinterpret_cast<T*>(words_ + at);
  }

 private:
  std::uint64_t* words_;
  std::size_t used_ = 0;
};

// Refit by moments. An asset without moments needs no words and gets none: it is a crowd of spheres only.
void add_moments(const AssetView& asset, Radius radius, TableMemory& memory, TableHeader& header);

}  // namespace spherechain::cuda
