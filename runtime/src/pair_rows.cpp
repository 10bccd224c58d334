// SPDX-License-Identifier: MIT
#include "pair_rows.h"

#include <algorithm>

#include "arithmetic.h"
#include "simd.h"
#include "triangle_bits.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pair_rows.cpp"
#include "highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

// Fills rows of both tables; `enabled` are the tile's columns' and rows' bits.
std::size_t choose(const PairChoice& choice, const TilePlace& place, const TileWords& enabled_columns,
                   const TileWords& enabled_rows, TileWords* wanted, TileWords* plain) {
  // Copies: for all the compiler knows, writing rows could change what it has by reference.
  const std::uint64_t* const ignored = choice.ignored.data;
  const std::size_t ignored_words = choice.ignored.size, row_count = place.row_count;
  const TileWords row_bits = enabled_rows;
  std::size_t count = 0;
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
      count += hwy::PopCount(chosen);
      wanted[r].words[word] = chosen;
      plain[r].words[word] = chosen;
    }
  }
  return count;
}

std::size_t count_chain(const TileWords& mask, const TileWords* wanted, TileWords* held) {
  std::size_t count = 0;
  for (std::size_t half = 0; half < kTileWords; ++half) {
    for (std::uint64_t rows = mask.words[half]; rows != 0; rows &= rows - 1) {
      const std::size_t r = 64 * half + hwy::Num0BitsBelowLS1Bit_Nonzero64(rows);
      for (std::size_t word = 0; word <= half; ++word) {  // a row's columns are before it
        count += hwy::PopCount(wanted[r].words[word] & mask.words[word]);
        held[r].words[word] |= mask.words[word];
      }
    }
  }
  return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(choose);
SPHERECHAIN_KERNELS(count_chain);

TileWords enabled(Span<const std::uint64_t> disabled, std::size_t first) {
  TileWords out;
  for (std::size_t w = 0; w < kTileWords; ++w) {
    const std::size_t word = first / 64 + w;
    out.words[w] = word < disabled.size ? ~disabled[word] : ~std::uint64_t{0};
  }
  return out;
}

}  // namespace

std::size_t fill_rows(Target resolved, const PairChoice& choice, const TilePlace& place, TileWords* wanted,
                      TileWords* plain) {
  std::fill(wanted, wanted + padded_rows(place.row_count), TileWords{});
  std::fill(plain, plain + padded_rows(place.row_count), TileWords{});
  const std::size_t count =
      choose_kernels[index_of(resolved)](choice, place, enabled(choice.disabled, place.first_column),
                                         enabled(choice.disabled, place.first_row), wanted, plain);
  const std::size_t first_row = place.first_row, row_count = place.row_count;
  const std::size_t first_column = place.first_column, column_count = place.column_count;
  for (const NearPair& near : choice.near) {
    const std::size_t row = near.b - first_row, column = near.a - first_column;
    if (row < row_count && column < column_count) {
      plain[row].words[column / 64] &= ~(std::uint64_t{1} << (column % 64));
    }
  }
  return count;
}

// Both words in registers: in memory each sphere would wait for the one before.
TileWords chain_mask(Span<const std::uint32_t> members) {
  static_assert(kTileWords == 2, "a low and a high word");
  std::uint64_t low = 0, high = 0;
  for (const std::uint32_t sphere : members) {
    const std::uint64_t bit = std::uint64_t{1} << (sphere % 64), is_high = sphere / 64;
    low |= bit & (is_high - 1);
    high |= bit & (0 - is_high);
  }
  return {{low, high}};
}

std::size_t fill_chain_rows(Target resolved, const Asset& asset, const TileWords* wanted, const TileWords* plain,
                            TileWords* chain_wanted, TileWords* chain_plain, TileWords* masks) {
  const std::size_t row_count = padded_rows(asset.spheres().size);
  TileWords* const held = chain_wanted;
  std::fill(held, held + row_count, TileWords{});
  std::size_t count = 0;
  for (std::size_t c = 0; c < asset.chain_count(); ++c) {
    const TileWords mask = chain_mask(asset.chain(c).spheres);
    count += count_chain_kernels[index_of(resolved)](mask, wanted, held);
    if (masks != nullptr) {
      masks[c] = mask;
    }
  }
  for (std::size_t r = 0; r < row_count; ++r) {
    for (std::size_t w = 0; w < kTileWords; ++w) {
      const std::uint64_t word = held[r].words[w];
      chain_wanted[r].words[w] = wanted[r].words[w] & word;
      chain_plain[r].words[w] = plain[r].words[w] & word;
    }
  }
  return count;
}

}  // namespace spherechain
#endif
