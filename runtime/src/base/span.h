// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace spherechain {

// A borrowed array.
template <typename T>
struct Span {
  T* data = nullptr;
  std::size_t size = 0;

  constexpr T& operator[](std::size_t i) const { return data[i]; }
  constexpr T* begin() const { return data; }
  constexpr T* end() const { return data + size; }
};

}  // namespace spherechain
