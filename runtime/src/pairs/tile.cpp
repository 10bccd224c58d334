// SPDX-License-Identifier: MIT
#include "runtime/src/pairs/tile.h"

#include <cstring>

#include "runtime/src/base/arithmetic.h"
#include "runtime/src/simd/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/src/pairs/tile.cpp"
#include "runtime/src/pairs/sphere_columns.h"
#include "runtime/src/simd/highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

using Floats = hn::ScalableTag<float>;
using Pairs = hn::ScalableTag<std::int32_t>;  // numbers below 2^31: offsets are of kTileSize spheres

// Tests kListLanes pairs at once and adds those that touch to `found`. Entries from `count` on are padding and ignored.
// Compress() keeps the pairs' order. When `found` is full, its output takes the pairs over.
HWY_INLINE void test_pairs(const Tile& tile, const ListedPair* pairs, hn::Vec<Floats> rest_scales, std::size_t count,
                           FoundPairs& found) {
  constexpr Floats kFloats;
  constexpr Pairs kPairs;
  const auto at = [](const Sphere* spheres, std::size_t bytes) -> const Sphere& {
    return *reinterpret_cast<const Sphere*>(reinterpret_cast<const char*>(spheres) + bytes);
  };
  auto touch = touching([&](std::size_t k) -> const Sphere& { return at(tile.columns, pairs[k].a); },
                        [&](std::size_t k) -> const Sphere& { return at(tile.rows, pairs[k].b); }, rest_scales);
  touch = hn::And(touch, hn::FirstN(kFloats, count));
  const auto numbers = hn::LoadU(kPairs, reinterpret_cast<const std::int32_t*>(pairs));
  const auto own = hn::RebindMask(kPairs, touch);
  hn::StoreU(hn::Compress(numbers, own), kPairs, reinterpret_cast<std::int32_t*>(found.pairs + found.count));
  found.count += hn::CountTrue(kPairs, own);
  if (HWY_UNLIKELY(found.count > kMaxFound)) {
    found.output.take(tile.place, found);
  }
}

// Removes unwanted pairs from the candidates of a group of strips. Returns one bit per strip, set if any candidate
// remains: strips without one are skipped.
HWY_INLINE std::uint64_t keep_wanted(const std::uint16_t* wanted, std::uint16_t* candidates) {
  constexpr hn::ScalableTag<std::uint16_t> kStrips;
  constexpr std::size_t kLanes = hn::MaxLanes(kStrips);
  std::uint64_t any = 0;
  for (std::size_t i = 0; i < kStripGroup; i += kLanes) {
    const auto kept = hn::And(hn::Load(kStrips, candidates + i), hn::LoadU(kStrips, wanted + i));
    hn::Store(kept, kStrips, candidates + i);
    std::uint64_t bits = 0;
    hn::StoreMaskBits(kStrips, hn::Ne(kept, hn::Zero(kStrips)), reinterpret_cast<std::uint8_t*>(&bits));
    any |= bits << i;
  }
  return any;
}

HWY_INLINE void clear_group(std::uint16_t* candidates) {
  constexpr hn::ScalableTag<std::uint16_t> kStrips;
  for (std::size_t i = 0; i < kStripGroup; i += hn::MaxLanes(kStrips)) {
    hn::Store(hn::Zero(kStrips), kStrips, candidates + i);
  }
}

// Lists the pairs of a strip whose bits are set in `wanted`, in ascending order. Returns their count. May write up to
// kBlock entries. Pairs hold byte offsets of spheres, so neighbouring columns differ by sizeof(Sphere).
HWY_INLINE std::size_t list_strip(const ListedPair& strip, std::uint16_t wanted, ListedPair* listed) {
#if HWY_TARGET == HWY_AVX3  // one register: no loop, whose end would be guessed wrong
  constexpr Pairs kPairs;
  const auto mask = hn::LoadMaskBits(kPairs, reinterpret_cast<const std::uint8_t*>(&wanted));
  std::int32_t first = 0;
  std::memcpy(&first, &strip, sizeof first);
  const auto steps = hn::Mul(hn::Iota(kPairs, 0), hn::Set(kPairs, sizeof(Sphere) << 16));
  const auto numbers = hn::Add(hn::Set(kPairs, first), steps);
  hn::StoreU(hn::Compress(numbers, mask), kPairs, reinterpret_cast<std::int32_t*>(listed));
  return hn::CountTrue(kPairs, mask);
#else
  std::size_t count = 0;
  for (std::uint64_t left = wanted; left != 0; left &= left - 1, ++count) {
    listed[count].a = static_cast<std::uint16_t>(strip.a + sizeof(Sphere) * hwy::Num0BitsBelowLS1Bit_Nonzero64(left));
    listed[count].b = strip.b;
  }
  return count;
#endif
}

// Marks the candidates: for each strip, the columns that may touch the row. If the spheres cannot be put into columns
// (fill_all() fails), all columns are marked. Both are correct, since each candidate is tested by the exact formula.
HWY_INLINE void find_candidates(const Tile& tile, std::uint16_t* candidates) {
  const TilePlace place = tile.place;
  const std::size_t strip_count = tile.lists->strip_count;
  const bool is_diagonal = place.is_diagonal();
  SphereColumns columns, rows;  // rows: where they are others
  if (fill_all(tile.columns, place.column_count, tile.columns[0], columns) &&
      (is_diagonal || fill_all(tile.rows, place.row_count, tile.columns[0], rows))) {
    clear_group(candidates + strip_count / kStripGroup * kStripGroup);
    for_candidates(
        columns, place.column_count, is_diagonal ? columns : rows, place.row_count,
        [&](std::size_t column) { return place.first_row_of(column); },
        [&](std::size_t strip, std::uint16_t bits) { candidates[strip] = bits; });
  } else {
    std::memset(candidates, 0xFF, (strip_count + kStripGroup) * sizeof *candidates);
  }
}

void find(const Tile& tile, FoundPairs& found) {
  constexpr Floats kFloats;
  const PairLists lists = *tile.lists;
  HWY_ALIGN std::uint16_t candidates[kMaxStrips + kStripGroup];
  find_candidates(tile, candidates);
  // Tests the rest pairs first, while the candidates' memory arrives.
  for (std::size_t i = 0; i < lists.rest_count; i += kListLanes) {
    test_pairs(tile, lists.rest_pairs + i, hn::LoadU(kFloats, lists.rest_scales + i), kListLanes, found);
  }
  constexpr std::size_t kEnough = 128;
  ListedPair listed[kEnough + kStripGroup * kBlock + kBlock];
  std::size_t listed_count = 0;
  for (std::size_t first = 0; first < lists.strip_count; first += kStripGroup) {
    std::uint64_t strips = keep_wanted(lists.wanted + first, candidates + first);
    for (; strips != 0; strips &= strips - 1) {
      const std::size_t strip = first + hwy::Num0BitsBelowLS1Bit_Nonzero64(strips);
      listed_count += list_strip(lists.strips[strip], candidates[strip], listed + listed_count);
    }
    if (listed_count <= kEnough && first + kStripGroup < lists.strip_count) {
      continue;
    }
    for (std::size_t i = 0; i < kListLanes; ++i) {
      listed[listed_count + i].a = listed[listed_count + i].b = 0;
    }
    for (std::size_t i = 0; i < listed_count; i += kListLanes) {
      test_pairs(tile, listed + i, hn::Set(kFloats, 1.0F), listed_count - i, found);
    }
    listed_count = 0;
  }
}

// Each pair's place is the number of those before it: of a register's pairs at once.
void sort(const FoundPairs& found, Pair* list, std::size_t size) {
  constexpr Pairs kPairs;
  constexpr std::size_t kLanes = hn::MaxLanes(kPairs);
  const auto* const numbers = reinterpret_cast<const std::int32_t*>(found.pairs);
  HWY_ALIGN std::uint32_t places[kLanes];
  for (std::size_t first = 0; first < found.count; first += kLanes) {
    const auto own = hn::Load(kPairs, numbers + first);
    auto before = hn::Zero(kPairs);
    for (std::size_t i = 0; i < found.count; ++i) {
      before = hn::Sub(before, hn::VecFromMask(kPairs, hn::Lt(hn::Set(kPairs, numbers[i]), own)));
    }
    hn::Store(before, kPairs, reinterpret_cast<std::int32_t*>(places));
    const ListedPair* const pairs = found.pairs + first;
    const std::size_t count = found.count - first < kLanes ? found.count - first : kLanes;
    for (std::size_t i = 0; i < count; ++i) {
      if (places[i] < size) {
        list[places[i]].a = static_cast<std::uint32_t>(pairs[i].a / sizeof(Sphere));
        list[places[i]].b = static_cast<std::uint32_t>(pairs[i].b / sizeof(Sphere));
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(find);
SPHERECHAIN_KERNELS(sort);

}  // namespace

void find_pairs(Target resolved, const Tile& tile, FoundPairs& found) { find_kernels[index_of(resolved)](tile, found); }

void list_in_order(Target resolved, const FoundPairs& found, Span<Pair> list) {
  sort_kernels[index_of(resolved)](found, list.data, list.size);
}

}  // namespace spherechain
#endif
