// SPDX-License-Identifier: MIT
// The parts that CrowdTables::build puts together.
#pragma once

#include <algorithm>

#include "crowd_view.h"

namespace spherechain::cuda {

constexpr std::size_t words_of(std::size_t bytes) { return (bytes + 15) / 16 * 2; }

// Arrays one after another in the caller's memory, zero where nothing is written.
class TableMemory {
 public:
  explicit TableMemory(Span<std::uint64_t> memory) : memory_(memory) {}

  template <typename T>
  T* take(std::size_t count, std::uint32_t& at) {
    at = static_cast<std::uint32_t>(used_);
    std::uint64_t* begin = memory_.data + used_;
    used_ += words_of(count * sizeof(T));
    std::fill(begin, memory_.data + used_, std::uint64_t{0});
    return reinterpret_cast<T*>(begin);
  }
  std::size_t used() const { return used_; }

 private:
  Span<std::uint64_t> memory_;
  std::size_t used_ = 0;
};

// Refit by moments. An asset of another rule needs no words and gets none: it is a crowd of spheres only.
std::size_t moment_words(const Asset& asset);
void add_moments(const Asset& asset, RadiusKind radius, TableMemory& memory, TableHeader& header);

}  // namespace spherechain::cuda
