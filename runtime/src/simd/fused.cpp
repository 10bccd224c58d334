// SPDX-License-Identifier: MIT
#include "runtime/src/simd/fused.h"

namespace spherechain {

// Rounds the sum to odd: what is not a double becomes the neighbour whose last bit is 1. A double so rounded rounds to
// the same float as the exact sum, for it has more than two bits a float has not, and is half way between two floats
// only where the exact sum is (Boldo and Melquiond, Emulation of FMA and correctly rounded sums, 2008).
float fused_multiply_add_slow(float a, float b, float c) noexcept {
  const double product = double{a} * double{b};
  const double summand = c;
  double sum = product + summand;
  const double rounded_summand = sum - product;
  const double error = (product - (sum - rounded_summand)) + (summand - rounded_summand);
  std::uint64_t bits = 0;
  std::memcpy(&bits, &sum, sizeof bits);
  if ((error < 0 || error > 0) && (bits & 1U) == 0) {
    bits = (error > 0) == (sum > 0) ? bits + 1 : bits - 1;
    std::memcpy(&sum, &bits, sizeof sum);
  }
  return static_cast<float>(sum);
}

}  // namespace spherechain
