// SPDX-License-Identifier: MIT
#include "pairs/overlap.h"

#include <cstring>

#include "simd/arithmetic.h"
#include "simd/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pairs/overlap.cpp"
#include "pairs/sphere_columns.h"
#include "simd/highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void fill(const Sphere* spheres, std::size_t count, const Sphere& origin, SphereColumns& columns) {
  columns.is_finite = fill_all(spheres, count, origin, columns);
}

// Sets at least the bits of the pairs that touch; and of other pairs, some of the columns after the row too.
HWY_INLINE void find_candidates(const Tile& tile) {
  auto* const bits = reinterpret_cast<std::uint8_t*>(tile.bits);
  for_candidates(
      *tile.columns, tile.place.column_count, *tile.rows, tile.place.row_count,
      [&](std::size_t first) { return first_row_of(tile.place, first); },
      [&](std::size_t, std::size_t r, std::size_t first, std::uint16_t block) {
        std::memcpy(bits + r * sizeof(TileWords) + first / 8, &block, sizeof block);
      });
}

// Some of a tile's words, as bits.
struct WordSet {
  std::uint64_t words[kTileSize * kTileWords / 64] = {};
};

// Of the candidates those that are plain, and which words have some.
HWY_INLINE WordSet keep_plain(const Tile& tile) {
  const hn::ScalableTag<std::uint64_t> kWords;
  constexpr std::size_t kLanes = hn::MaxLanes(kWords);
  WordSet out;
  std::uint64_t* const bits = tile.bits->words;
  const std::uint64_t* const plain = tile.plain->words;
  const std::size_t count = kTileWords * padded_rows(tile.place.row_count);
  for (std::size_t first = 0; first < count; first += 64) {
    const std::size_t end = count - first < 64 ? count - first : 64;
    std::uint64_t any = 0;
    for (std::size_t i = 0; i < end; i += kLanes) {
      const auto kept = hn::And(hn::LoadU(kWords, bits + first + i), hn::LoadU(kWords, plain + first + i));
      hn::StoreU(kept, kWords, bits + first + i);
      std::uint8_t mask[8] = {};
      hn::StoreMaskBits(kWords, hn::Ne(kept, hn::Zero(kWords)), mask);
      any |= std::uint64_t{mask[0]} << i;
    }
    out.words[first / 64] = any;
  }
  return out;
}

// Tests pairs by the rule: a is a column's number, b a row's. Those that touch and are wanted get their bits.
class Listing {
 public:
  HWY_INLINE explicit Listing(Tile& tile) : tile_(tile) {}

  // kListLanes pairs, those of them whose bits are in `lanes`.
  HWY_INLINE void test(const RestPair* pairs, std::uint64_t lanes) {
    std::uint64_t left = test_listed(tile_.column_spheres, tile_.row_spheres, pairs) & lanes;
    for (; left != 0; left &= left - 1) {
      const RestPair& pair = pairs[hwy::Num0BitsBelowLS1Bit_Nonzero64(left)];
      const std::size_t word = pair.a / 64;
      const std::uint64_t bit = tile_.wanted[pair.b].words[word] & (std::uint64_t{1} << (pair.a % 64));
      tile_.bits[pair.b].words[word] |= bit;
      hits_.words[pair.b / 32] |= std::uint64_t{bit != 0} << (kTileWords * (pair.b % 32) + word);
    }
  }

  // One by one: tested when there are enough of them, or at the end.
  HWY_INLINE void add(std::uint32_t a, std::uint32_t b, float rest_scale) {
    pairs_[count_].a = a;
    pairs_[count_].b = b;
    pairs_[count_].rest_scale = rest_scale;
    if (++count_ == kListLanes) {
      test(pairs_, ~std::uint64_t{0});
      count_ = 0;
    }
  }
  HWY_INLINE void finish() {
    if (count_ > 0) {
      for (std::size_t k = count_; k < kListLanes; ++k) {
        pairs_[k] = pairs_[0];
      }
      test(pairs_, (std::uint64_t{1} << count_) - 1);
      count_ = 0;
    }
  }

  HWY_INLINE const WordSet& hits() const { return hits_; }

 private:
  Tile& tile_;
  RestPair pairs_[kListLanes];
  std::size_t count_ = 0;
  WordSet hits_;
};

// Candidates lose their bits, and those that touch get them back.
HWY_INLINE void test_candidates(Tile& tile, const WordSet& candidates, Listing& listing) {
  for (std::size_t group = 0; group < kTileSize * kTileWords / 64; ++group) {
    for (std::uint64_t words = candidates.words[group]; words != 0; words &= words - 1) {
      const std::size_t i = 64 * group + hwy::Num0BitsBelowLS1Bit_Nonzero64(words);
      const std::size_t r = i / kTileWords, word = i % kTileWords;
      std::uint64_t left = tile.bits[r].words[word];
      tile.bits[r].words[word] = 0;
      for (; left != 0; left &= left - 1) {
        const std::size_t column = 64 * word + hwy::Num0BitsBelowLS1Bit_Nonzero64(left);
        listing.add(static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(r), 1.0F);
      }
    }
  }
}

HWY_INLINE void test_rest_pairs(const Tile& tile, Listing& listing) {
  const TilePlace place = tile.place;
  const RestPair* const rest_pairs = tile.rest_pairs.data;
  const std::size_t rest_count = tile.rest_pairs.size;
  std::size_t i = 0;
  if (tile.is_whole) {
    for (; i + kListLanes <= rest_count; i += kListLanes) {
      listing.test(rest_pairs + i, ~std::uint64_t{0});
    }
  }
  for (; i < rest_count; ++i) {
    const auto column = static_cast<std::uint32_t>(rest_pairs[i].a - place.first_column),
               row = static_cast<std::uint32_t>(rest_pairs[i].b - place.first_row);
    if (row < place.row_count) {
      listing.add(column, row, rest_pairs[i].rest_scale);
    }
  }
}

HWY_INLINE void list_hits(const WordSet& hits, Tile& tile) {
  std::size_t count = 0;
  for (std::size_t group = 0; group < kTileSize * kTileWords / 64; ++group) {
    for (std::uint64_t words = hits.words[group]; words != 0; words &= words - 1) {
      tile.hits[count++] = static_cast<std::uint8_t>(64 * group + hwy::Num0BitsBelowLS1Bit_Nonzero64(words));
    }
  }
  tile.hit_count = count;
}

void test(Tile& tile) {
  if (tile.rows->is_finite && tile.columns->is_finite) {
    std::memset(static_cast<void*>(tile.bits), 0, padded_rows(tile.place.row_count) * sizeof(TileWords));
    find_candidates(tile);
  } else {
    std::memset(static_cast<void*>(tile.bits), 0xFF, padded_rows(tile.place.row_count) * sizeof(TileWords));
  }
  Listing listing(tile);
  test_candidates(tile, keep_plain(tile), listing);
  test_rest_pairs(tile, listing);
  listing.finish();
  list_hits(listing.hits(), tile);
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(fill);
SPHERECHAIN_KERNELS(test);

}  // namespace

void fill_columns(Target resolved, const Sphere* spheres, std::size_t count, const Sphere& origin,
                  SphereColumns& columns) {
  fill_kernels[index_of(resolved)](spheres, count, origin, columns);
}

void test_tile(Target resolved, Tile& tile) { test_kernels[index_of(resolved)](tile); }

}  // namespace spherechain
#endif
