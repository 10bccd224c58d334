// SPDX-License-Identifier: MIT
// Draws that are the same with every standard library.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>

namespace spherechain::test {

// 2^exponent; where sizes are of 32 bits the largest one.
constexpr std::size_t power_of_two(unsigned exponent) {
  return exponent < 8 * sizeof(std::size_t) ? std::size_t{1} << exponent : ~std::size_t{0};
}

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t bits() { return engine_(); }
  std::uint32_t below(std::uint32_t end) { return static_cast<std::uint32_t>((engine_() >> 32) * end >> 32); }
  std::size_t up_to(std::size_t last) { return below(static_cast<std::uint32_t>(last + 1)); }
  bool one_in(std::uint32_t n) { return below(n) == 0; }
  template <typename T, std::size_t kCount>
  T pick(const T (&values)[kCount]) {
    return values[below(kCount)];
  }
  // In [-1, 1).
  float figure() { return static_cast<float>(below(1U << 24)) / 8388608.0F - 1.0F; }

 private:
  std::mt19937_64 engine_;
};

}  // namespace spherechain::test
