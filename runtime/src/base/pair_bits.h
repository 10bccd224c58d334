// SPDX-License-Identifier: MIT
// One bit for each pair of n spheres.
#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/src/base/span.h"
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

// 64 bits from the `at`th on; those past the end are any.
inline std::uint64_t bits_at(const std::uint64_t* words, std::size_t size, std::size_t at) {
  const std::size_t word = at / 64;
  const std::size_t shift = at % 64;
  const std::uint64_t next = words[word + (word + 1 < size ? 1 : 0)];
  return (words[word] >> shift) | ((next << 1) << (63 - shift));
}

// In a table indexed by sorted_bit, the bits of a's pairs with spheres first to first + 63, as far as those come after
// a. `first` is before n and less than 64 before a.
inline std::uint64_t sorted_row_bits(const std::uint64_t* words, std::size_t size, std::size_t a, std::size_t first,
                                     std::size_t n) {
  if (a + 1 == n) {
    return 0;
  }
  const std::uint64_t in_row = n - first < 64 ? ~std::uint64_t{0} >> (64 - (n - first)) : ~std::uint64_t{0};
  return first > a ? bits_at(words, size, sorted_bit(a, first, n)) & in_row
                   : bits_at(words, size, row_begin(a, n)) << (a + 1 - first) & in_row;
}

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

// The pairs whose bits are set in a table of n spheres by ignored_bit, b ascending and then a. Bits past the pairs are
// not looked at.
template <typename Use>
void for_each_pair(const std::uint64_t* words, std::size_t n, const Use& use) {
  const std::size_t count = pairs_of(n);
  std::size_t b = 1, row = 0;
  for (std::size_t first = 0; first < count; first += 64) {
    std::uint64_t word = words[first / 64] & (~std::uint64_t{0} >> (count - first < 64 ? 64 - (count - first) : 0));
    for (; word != 0; word &= word - 1) {
      const std::size_t bit = first + lowest_bit(word);
      while (bit >= row + b) {
        row += b;
        ++b;
      }
      use(static_cast<std::uint32_t>(bit - row), static_cast<std::uint32_t>(b));
    }
  }
}

}  // namespace spherechain
