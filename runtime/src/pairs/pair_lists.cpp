// SPDX-License-Identifier: MIT
#include "runtime/src/pairs/pair_lists.h"

#include "runtime/src/base/arithmetic.h"
#include "runtime/src/base/pair_bits.h"
#include "runtime/src/simd/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/src/pairs/pair_lists.cpp"
#include "runtime/src/simd/highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

std::size_t fill(const PairChoice& choice, const TilePlace& place, const PairListBuffers& buffers) {
  const Span<const std::uint64_t> ignored = choice.ignored;
  std::uint16_t* wanted = buffers.wanted;
  ListedPair* strips = buffers.strips;
  for (TwoBlocks blocks(place); blocks.first_column() < place.column_count; blocks.advance()) {
    const std::size_t a = place.first_column + blocks.first_column();
    const std::size_t first_row = blocks.first_row(), both = first_row + blocks.single_rows();
    std::uint64_t before =
        place.is_diagonal() ? 1 : ~std::uint64_t{0};  // the columns before the row: the tile has them all
    std::size_t b = place.first_row + first_row, bit = ignored_bit(a, b);
    for (std::size_t row = first_row; row < place.row_count; ++row, ++b) {
      const std::uint64_t bits = before & ~bits_at(ignored.data, ignored.size, bit);
      bit += b;
      before = before << 1 | 1;
      *wanted++ = static_cast<std::uint16_t>(bits);
      if (row >= both) {
        *wanted++ = static_cast<std::uint16_t>(bits >> kBlock);
      }
    }
    for (std::size_t row = first_row; row < both && row < place.row_count; ++row) {
      *strips++ = listed_pair(blocks.first_column(), row);
    }
    for (std::size_t row = both; row < place.row_count; ++row, strips += 2) {
      strips[0] = listed_pair(blocks.first_column(), row);
      strips[1] = listed_pair(blocks.first_column() + kBlock, row);
    }
  }
  const auto strip_count = static_cast<std::size_t>(wanted - buffers.wanted);
  for (std::size_t i = strip_count; i % kStripGroup != 0; ++i) {
    *wanted++ = 0;
  }
  return strip_count;
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(fill);

}  // namespace

std::size_t fill_strips(Target resolved, const PairChoice& choice, const TilePlace& place,
                        const PairListBuffers& buffers) {
  return fill_kernels[index_of(resolved)](choice, place, buffers);
}

std::size_t move_rest_pairs(Span<const RestPair>& rest_pairs, const TilePlace& place, const PairListBuffers& buffers) {
  const PairListBuffers to = buffers;
  TwoBlocks blocks(place);
  std::size_t count = 0;
  const RestPair *pair = rest_pairs.begin(), *const end = rest_pairs.end();
  for (; pair < end && count < to.rest_room; ++pair) {
    const std::size_t column = pair->a - place.first_column, row = pair->b - place.first_row;
    if (row >= place.row_count) {
      continue;
    }
    while (column >= blocks.first_column() + 2 * kBlock) {  // rest pairs are sorted
      blocks.advance();
    }
    std::uint16_t& wanted = to.wanted[blocks.strip_of(column, row)];
    const std::uint32_t bit = 1U << (column % kBlock);
    to.rest_pairs[count] = listed_pair(column, row);
    to.rest_scales[count] = pair->rest_scale;
    count += (wanted & bit) != 0 ? 1 : 0;
    wanted = static_cast<std::uint16_t>(wanted & ~bit);
  }
  rest_pairs = {pair, static_cast<std::size_t>(end - pair)};
  for (; count % kBlock != 0; ++count) {
    to.rest_pairs[count] = {};
    to.rest_scales[count] = 0;
  }
  return count;
}

}  // namespace spherechain
#endif
