// SPDX-License-Identifier: MIT
// Memory from a caller's allocator, and arrays that lie in it.
#pragma once

#include <cstdint>

#include "runtime/src/skin/skin_table.h"
#include "spherechain/model.h"

namespace spherechain {

inline constexpr std::size_t kBlockAlignment = 64;

// An allocator that is complete, or malloc's where there is none. SC_NULL where one function is missing.
Status choose_allocator(const sc_allocator* wanted, const sc_allocator& otherwise, sc_allocator& out);
const sc_allocator& malloc_allocator();

// Words that an object owns.
struct Block {
  std::uint64_t* words = nullptr;
  std::size_t count = 0;

  bool allocate(const sc_allocator& allocator, std::size_t wanted);
  void release(const sc_allocator& allocator);
};

}  // namespace spherechain
