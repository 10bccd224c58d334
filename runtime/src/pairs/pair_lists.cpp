// SPDX-License-Identifier: MIT
#include "pairs/pair_lists.h"

#include "pairs/pair_bits.h"
#include "simd/arithmetic.h"
#include "simd/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pairs/pair_lists.cpp"
#include "simd/highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

std::size_t fill(const PairChoice& choice, const TilePlace& place, const PairListBuffers& buffers) {
  const Span<const std::uint64_t> ignored = choice.ignored, disabled = choice.disabled;
  const std::size_t row_count = place.row_count;
  std::size_t strip = 0;
  for (std::size_t first = 0; first < place.column_count; first += 2 * kBlock) {
    const std::size_t columns_left = place.column_count - first;
    const std::size_t most = columns_left < 2 * kBlock ? columns_left : 2 * kBlock;
    const std::size_t a = place.first_column + first, both = place.first_row_of(first + kBlock);
    const std::uint64_t enabled = disabled.size == 0 ? ~std::uint64_t{0} : ~bits_at(disabled.data, disabled.size, a);
    std::size_t row = place.first_row_of(first), b = place.first_row + row, bit = ignored_bit(a, b);
    for (; row < row_count; ++row, ++b) {
      const std::size_t held = b - a < most ? b - a : most;  // columns before the row
      std::uint64_t wanted = enabled & (~std::uint64_t{0} >> (64 - held)) & ~bits_at(ignored.data, ignored.size, bit);
      if (disabled.size > 0 && test_bit(disabled, b)) {
        wanted = 0;
      }
      bit += b;
      buffers.wanted[strip] = static_cast<std::uint16_t>(wanted);
      buffers.strips[strip] = listed_pair(first, row);
      ++strip;
      if (row >= both) {
        buffers.wanted[strip] = static_cast<std::uint16_t>(wanted >> kBlock);
        buffers.strips[strip] = listed_pair(first + kBlock, row);
        ++strip;
      }
    }
  }
  for (std::size_t i = strip; i % kStripGroup != 0; ++i) {
    buffers.wanted[i] = 0;
    buffers.strips[i] = {};
  }
  return strip;
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(fill);

// The strip that holds the pair.
std::size_t strip_at(const TilePlace& place, std::size_t column, std::size_t row) {
  const std::size_t two_blocks = column / (2 * kBlock), in_row = column / kBlock % 2;
  const std::size_t first_row = place.first_row_of(2 * kBlock * two_blocks);
  if (!place.is_diagonal()) {
    return 2 * (two_blocks * place.row_count + row) + in_row;
  }
  // The first kBlock rows of two blocks have a strip with the first block only.
  const std::size_t before =
      two_blocks * (2 * (place.row_count - 1) - kBlock) - kBlock * two_blocks * (two_blocks - 1) * 2;
  const std::size_t rows = row - first_row;
  return before + rows + (rows > kBlock ? rows - kBlock : 0) + in_row;
}

}  // namespace

std::size_t fill_strips(Target resolved, const PairChoice& choice, const TilePlace& place,
                        const PairListBuffers& buffers) {
  return fill_kernels[index_of(resolved)](choice, place, buffers);
}

std::size_t move_rest_pairs(Span<const RestPair>& rest_pairs, const TilePlace& place, const PairListBuffers& buffers) {
  std::size_t count = 0, taken = 0;
  for (; taken < rest_pairs.size && count < buffers.rest_room; ++taken) {
    const RestPair& pair = rest_pairs[taken];
    const std::size_t column = pair.a - place.first_column, row = pair.b - place.first_row;
    if (column >= place.column_count || row >= place.row_count) {
      continue;
    }
    std::uint16_t& wanted = buffers.wanted[strip_at(place, column, row)];
    const std::uint32_t bit = 1U << (column % kBlock);
    if ((wanted & bit) != 0) {
      wanted = static_cast<std::uint16_t>(wanted & ~bit);
      buffers.rest_pairs[count] = listed_pair(column, row);
      buffers.rest_scales[count++] = pair.rest_scale;
    }
  }
  rest_pairs = {rest_pairs.data + taken, rest_pairs.size - taken};
  for (; count % kBlock != 0; ++count) {
    buffers.rest_pairs[count] = {};
    buffers.rest_scales[count] = 0;
  }
  return count;
}

}  // namespace spherechain
#endif
