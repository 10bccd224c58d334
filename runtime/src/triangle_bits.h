// SPDX-License-Identifier: MIT
// One bit for each pair of n spheres.
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/types.h"

#if defined(_MSC_VER)
#include <intrin.h>
#endif

namespace spherechain {

constexpr std::size_t pairs_of(std::size_t n) { return n < 2 ? 0 : n * (n - 1) / 2; }

constexpr std::size_t words_for(std::size_t bits) { return (bits + 63) / 64; }

inline bool test_bit(Span<const std::uint64_t> words, std::size_t bit) {
  return ((words[bit / 64] >> (bit % 64)) & 1U) != 0;
}

inline void set_bit(Span<std::uint64_t> words, std::size_t bit) { words[bit / 64] |= std::uint64_t{1} << (bit % 64); }

inline void assign_bit(Span<std::uint64_t> words, std::size_t bit, bool value) {
  const std::uint64_t mask = std::uint64_t{1} << (bit % 64);
  words[bit / 64] = value ? words[bit / 64] | mask : words[bit / 64] & ~mask;
}

// The schema's order of the ignored pairs: independent of n.
constexpr std::size_t ignored_bit(std::size_t a, std::size_t b) { return b * (b - 1) / 2 + a; }

// Bits in the order of sorted pairs (a, b), so that reading them upwards reads the pairs sorted.
constexpr std::size_t row_begin(std::size_t a, std::size_t n) { return a * (2 * n - a - 1) / 2; }
constexpr std::size_t sorted_bit(std::size_t a, std::size_t b, std::size_t n) { return row_begin(a, n) + (b - a - 1); }

// `word` is not 0.
inline unsigned lowest_bit(std::uint64_t word) {
#if defined(_MSC_VER)
  unsigned long index = 0;
  _BitScanForward64(&index, word);
  return index;
#else
  return static_cast<unsigned>(__builtin_ctzll(word));
#endif
}

}  // namespace spherechain
