// SPDX-License-Identifier: MIT
#include "pairs/pair_rows.h"

#include <algorithm>

#include "pairs/pair_bits.h"
#include "simd/arithmetic.h"
#include "simd/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pairs/pair_rows.cpp"
#include "simd/highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

// Fills rows of both tables; `enabled` are the tile's columns' and rows' bits.
void choose(const PairChoice& choice, const TilePlace& place, const TileWords& enabled_columns,
            const TileWords& enabled_rows, TileWords* wanted, TileWords* plain) {
  // Copies: for all the compiler knows, writing rows could change what it has by reference.
  const std::uint64_t* const ignored = choice.ignored.data;
  const std::size_t ignored_words = choice.ignored.size, row_count = place.row_count;
  const TileWords row_bits = enabled_rows;
  for (std::size_t word = 0; 64 * word < place.column_count; ++word) {
    const std::size_t columns_left = place.column_count - 64 * word;
    const std::size_t most = columns_left < 64 ? columns_left : 64;
    const std::uint64_t columns = enabled_columns.words[word];
    const std::size_t first_column = place.first_column + 64 * word;
    std::size_t r = first_row_of(place, 64 * word);
    std::size_t below = place.first_row + r - first_column;
    std::size_t bit = (place.first_row + r) * (place.first_row + r - 1) / 2 + first_column;
    for (; r < row_count; ++r) {
      const std::size_t held = below < most ? below : most;
      const std::uint64_t row = 0 - ((row_bits.words[r / 64] >> (r % 64)) & 1U);
      const std::uint64_t chosen =
          row & columns & (~std::uint64_t{0} >> (64 - held)) & ~bits_at(ignored, ignored_words, bit);
      bit += first_column + below;  // the row's own number
      ++below;
      wanted[r].words[word] = chosen;
      plain[r].words[word] = chosen;
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(choose);

TileWords enabled(Span<const std::uint64_t> disabled, std::size_t first) {
  TileWords out;
  for (std::size_t w = 0; w < kTileWords; ++w) {
    const std::size_t word = first / 64 + w;
    out.words[w] = word < disabled.size ? ~disabled[word] : ~std::uint64_t{0};
  }
  return out;
}

}  // namespace

void fill_rows(Target resolved, const PairChoice& choice, const TilePlace& place, TileWords* wanted, TileWords* plain) {
  std::fill(wanted, wanted + padded_rows(place.row_count), TileWords{});
  std::fill(plain, plain + padded_rows(place.row_count), TileWords{});
  choose_kernels[index_of(resolved)](choice, place, enabled(choice.disabled, place.first_column),
                                     enabled(choice.disabled, place.first_row), wanted, plain);
  const std::size_t first_row = place.first_row, row_count = place.row_count;
  const std::size_t first_column = place.first_column, column_count = place.column_count;
  for (const RestPair& pair : choice.rest_pairs) {
    const std::size_t row = pair.b - first_row, column = pair.a - first_column;
    if (row < row_count && column < column_count) {
      plain[row].words[column / 64] &= ~(std::uint64_t{1} << (column % 64));
    }
  }
}

}  // namespace spherechain
#endif
