// SPDX-License-Identifier: MIT
// a * b + c rounded once, for machines that have no such instruction.
#pragma once

#include <cstdint>
#include <cstring>

#include "runtime/src/base/arithmetic.h"

namespace spherechain {

// For what the function below cannot decide.
float fused_multiply_add_slow(float a, float b, float c) noexcept;

// A product of floats is exact in double precision, and so rounded twice is only the sum: to double, then to float.
// That is the sum rounded once, unless the double lies half way between two floats. Where it does, or where the floats
// are spaced otherwise for it is below the least normal one, 2^-126, is looked at again. Infinities and NaNs are
// never looked at again.
inline bool may_round_twice(std::uint64_t sum) {
  const std::uint64_t magnitude = sum << 1 >> 1;
  return (sum & 0x1FFFFFFFU) == 0x10000000U || (magnitude != 0 && magnitude < 0x3810000000000000U);
}

inline float fused_multiply_add(float a, float b, float c) {
  const double sum = double{a} * double{b} + double{c};
  std::uint64_t bits = 0;
  std::memcpy(&bits, &sum, sizeof bits);
  return may_round_twice(bits) ? fused_multiply_add_slow(a, b, c) : static_cast<float>(sum);
}

}  // namespace spherechain
