// SPDX-License-Identifier: MIT
#include "overlap.h"

#include <cfloat>
#include <cstring>

#include "arithmetic.h"
#include "simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "overlap.cpp"
#include "highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::ScalableTag<float>;
using Vector = hn::Vec<Floats>;

// The spheres of a whole vector. Returns what their extents raise the lanes of `extent` to.
HWY_INLINE Vector fill_vector(const float* spheres, const Sphere& origin, Vector extent, SphereColumns& columns,
                              std::size_t i) {
  constexpr Floats kFloats;
  Vector x, y, z, radius;
  hn::LoadInterleaved4(kFloats, spheres, x, y, z, radius);
  x = hn::Sub(x, hn::Set(kFloats, origin.x));
  y = hn::Sub(y, hn::Set(kFloats, origin.y));
  z = hn::Sub(z, hn::Set(kFloats, origin.z));
  const Vector squared_radius = hn::Mul(radius, radius);
  const Vector squared_length = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
  hn::StoreU(x, kFloats, columns.x + i);
  hn::StoreU(y, kFloats, columns.y + i);
  hn::StoreU(z, kFloats, columns.z + i);
  hn::StoreU(radius, kFloats, columns.radius + i);
  hn::StoreU(hn::Mul(hn::Set(kFloats, 0.5F), hn::Sub(squared_length, squared_radius)), kFloats, columns.power + i);
  const Vector own = hn::Add(squared_length, squared_radius);
  // NaN becomes infinite, so that it stays.
  const Vector known = hn::IfThenElse(hn::Le(own, hn::Set(kFloats, FLT_MAX)), own, hn::Inf(kFloats));
  return hn::Max(extent, known);
}

void fill(const Sphere* spheres, std::size_t count, const Sphere& origin, SphereColumns& columns) {
  constexpr Floats kFloats;
  const std::size_t lanes = hn::Lanes(kFloats);
  Vector extent = hn::Zero(kFloats);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    extent = fill_vector(&spheres[i].x, origin, extent, columns, i);
  }
  const std::size_t whole = i;
  for (; i < count || i % kBlock != 0; i += lanes) {  // the lanes past the end are never asked for
    for (float* column : {columns.x, columns.y, columns.z, columns.radius, columns.power}) {
      hn::Store(hn::Zero(kFloats), kFloats, column + i);
    }
  }
  if (whole < count && count >= lanes) {
    extent = fill_vector(&spheres[count - lanes].x, origin, extent, columns, count - lanes);
  } else if (whole < count) {
    Sphere rest[hn::MaxLanes(kFloats)];
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      rest[lane] = lane < count ? spheres[lane] : origin;
    }
    extent = fill_vector(&rest[0].x, origin, extent, columns, 0);
  }
  columns.extent = hn::GetLane(hn::MaxOfLanes(kFloats, extent));
}

// How much a pair's test below may be off. With p and q as the tile has them, h(p) = (|p|^2 - rp^2) / 2 and u = 2^-24,
//   h(p) + h(q) - p.q - rp rq = (|p - q|^2 - (rp + rq)^2) / 2,
// which is below 0 where spheres touch. With G at least |p|^2 + rp^2 of every sphere, computing it costs 13 u G at
// most: 2 for each h, 7 for the sum of products (fused or not), each below 1.5 G, 1 for the comparison's side and 1 for
// terms of second order; moving the spheres to the tile's origin costs 4; and that the rule's own squares are rounded,
// by 8 u (rp + rq)^2 <= 32 u G, costs half of that. 33 u G in all, of which we allow 64; and 2^-120 for what underflows
// or is flushed to 0. So no pair is missed; what the rule then says no to are the few within that margin. Up to
// kMostExtent nothing above, nor of the rule, overflows.
HWY_INLINE float margin_of(float extent) { return kMarginOfExtent * extent + kLeastMargin; }

// The first row that has pairs with the column of the tile and those after it: of the pairs (a, b) only those with a <
// b.
HWY_INLINE std::size_t first_row_of(const Tile& tile, std::size_t column) {
  const std::size_t after = tile.first_column + column + 1;
  return after > tile.first_row ? after - tile.first_row : 0;
}

#if HWY_TARGET != HWY_AVX3

// Sets at least the bits of the pairs that touch; and of other pairs, those of the columns after the row too.
HWY_INLINE void find_candidates(const Tile& tile, float extent) {
  constexpr Floats kFloats;
  constexpr std::size_t kLanes = hn::MaxLanes(kFloats);
  constexpr std::size_t kParts = kBlock / kLanes;
  const SphereColumns& columns = *tile.columns;
  const SphereColumns& rows = *tile.rows;
  const Vector margin = hn::Set(kFloats, margin_of(extent));
  const std::size_t row_count = tile.row_count;
  std::memset(tile.bits, 0, row_count * sizeof tile.bits[0]);
  for (std::size_t first = 0; first < tile.column_count; first += kBlock) {
    Vector x[kParts], y[kParts], z[kParts], radius[kParts], start[kParts];
    for (std::size_t part = 0; part < kParts; ++part) {
      const std::size_t at = first + part * kLanes;
      x[part] = hn::Load(kFloats, columns.x + at);
      y[part] = hn::Load(kFloats, columns.y + at);
      z[part] = hn::Load(kFloats, columns.z + at);
      radius[part] = hn::Load(kFloats, columns.radius + at);
      start[part] = hn::Sub(margin, hn::Load(kFloats, columns.power + at));
    }
    auto* out = reinterpret_cast<std::uint8_t*>(tile.bits) + first / 8;
    for (std::size_t r = first_row_of(tile, first); r < row_count; ++r) {
      const Vector px = hn::Set(kFloats, rows.x[r]);
      const Vector py = hn::Set(kFloats, rows.y[r]);
      const Vector pz = hn::Set(kFloats, rows.z[r]);
      const Vector pr = hn::Set(kFloats, rows.radius[r]);
      const Vector power = hn::Set(kFloats, rows.power[r]);
      std::uint64_t bits = 0;
      for (std::size_t part = 0; part < kParts; ++part) {
        Vector sum = hn::MulAdd(px, x[part], start[part]);
        sum = hn::MulAdd(py, y[part], sum);
        sum = hn::MulAdd(pz, z[part], sum);
        sum = hn::MulAdd(pr, radius[part], sum);
        bits |= bits_of(hn::Gt(sum, power)) << (part * kLanes);
      }
      const auto block = static_cast<std::uint16_t>(bits);
      std::memcpy(out + r * sizeof tile.bits[0], &block, sizeof block);
    }
  }
}

#endif

// 64 bits from the `at`th on; those past the end are any.
HWY_INLINE std::uint64_t bits_at(const std::uint64_t* words, std::size_t size, std::size_t at) {
  const std::size_t word = at / 64;
  const std::size_t shift = at % 64;
  const std::uint64_t next = words[word + (word + 1 < size ? 1 : 0)];
  return (words[word] >> shift) | ((next << 1) << (63 - shift));
}

HWY_INLINE void take_all_as_candidates(Tile& tile) {
  std::memset(tile.bits, 0, tile.row_count * sizeof tile.bits[0]);
  for (std::size_t word = 0; 64 * word < tile.column_count; ++word) {
    for (std::size_t r = first_row_of(tile, 64 * word); r < tile.row_count; ++r) {
      tile.bits[r][word] = ~std::uint64_t{0};
    }
  }
}

// Leaves the bits of pairs that are wanted, and lists the words that have some. What the loops read is copied first:
// for all the compiler knows, writing bits could change it.
template <bool kStoresWanted>
HWY_INLINE void keep_wanted(Tile& tile) {
  const std::size_t row_count = tile.row_count, column_count = tile.column_count, ignored_words = tile.ignored_words;
  const std::uint64_t* const ignored = tile.ignored;
  std::uint64_t(*const bits)[kTileWords] = tile.bits;
  std::uint64_t(*const wanted_bits)[kTileWords] = tile.wanted;
  std::uint8_t* const hits = tile.hits;
  std::uint64_t enabled_rows[kTileWords];
  std::memcpy(enabled_rows, tile.enabled_rows, sizeof enabled_rows);
  if (kStoresWanted) {
    std::memset(wanted_bits, 0, row_count * sizeof wanted_bits[0]);
  }
  std::size_t test_count = 0, hit_count = 0;
  for (std::size_t word = 0; 64 * word < column_count; ++word) {
    const std::size_t columns_left = column_count - 64 * word;
    const std::size_t most = columns_left < 64 ? columns_left : 64;
    const std::uint64_t enabled_columns = tile.enabled_columns[word];
    const std::size_t first_column = tile.first_column + 64 * word;
    std::size_t r = first_row_of(tile, 64 * word);
    std::size_t below = tile.first_row + r - first_column;
    std::size_t bit = (tile.first_row + r) * (tile.first_row + r - 1) / 2 + first_column;
    for (; r < row_count; ++r) {
      const std::size_t count = below < most ? below : most;
      const std::uint64_t row = 0 - ((enabled_rows[r / 64] >> (r % 64)) & 1U);
      const std::uint64_t wanted =
          row & enabled_columns & (~std::uint64_t{0} >> (64 - count)) & ~bits_at(ignored, ignored_words, bit);
      bit += first_column + below;  // the row's own number
      ++below;
      test_count += hwy::PopCount(wanted);
      if (kStoresWanted) {
        wanted_bits[r][word] = wanted;
      }
      const std::uint64_t kept = bits[r][word] & wanted;
      bits[r][word] = kept;
      hits[hit_count] = static_cast<std::uint8_t>(kTileWords * r + word);
      hit_count += kept != 0 ? 1 : 0;
    }
  }
  tile.test_count = test_count;
  tile.hit_count = hit_count;
}

#if HWY_TARGET == HWY_AVX3

// Counts of what test_rows found so far.
struct Found {
  std::size_t tests, hits;
};

// find_candidates and keep_wanted of rows [r, end) and the first kBlocks blocks of the word's columns, which the
// registers hold all of.
template <std::size_t kBlocks, bool kStoresWanted, bool kAllEnabled>
HWY_INLINE void test_rows(const Tile& tile, std::size_t word, std::size_t r, std::size_t end, Vector margin,
                          std::uint8_t* hits, Found& found) {
  constexpr Floats kFloats;
  static_assert(hn::MaxLanes(kFloats) == kBlock, "a block a register");
  Vector x[kBlocks], y[kBlocks], z[kBlocks], radius[kBlocks], start[kBlocks];
  for (std::size_t block = 0; block < kBlocks; ++block) {
    const std::size_t at = 64 * word + block * kBlock;
    x[block] = hn::Load(kFloats, tile.columns->x + at);
    y[block] = hn::Load(kFloats, tile.columns->y + at);
    z[block] = hn::Load(kFloats, tile.columns->z + at);
    radius[block] = hn::Load(kFloats, tile.columns->radius + at);
    start[block] = hn::Sub(margin, hn::Load(kFloats, tile.columns->power + at));
  }
  const SphereColumns& rows = *tile.rows;
  const std::uint64_t* const ignored = tile.ignored;
  const std::size_t ignored_words = tile.ignored_words;
  std::uint64_t(*const bits)[kTileWords] = tile.bits;
  const std::size_t columns_left = tile.column_count - 64 * word;
  const std::size_t most = columns_left < 64 ? columns_left : 64;
  const std::size_t first_column = tile.first_column + 64 * word;
  std::size_t below = tile.first_row + r - first_column;
  std::size_t bit = (tile.first_row + r) * (tile.first_row + r - 1) / 2 + first_column;
  std::size_t test_count = found.tests, hit_count = found.hits;
  for (; r < end; ++r) {
    const Vector px = hn::Set(kFloats, rows.x[r]), py = hn::Set(kFloats, rows.y[r]), pz = hn::Set(kFloats, rows.z[r]),
                 pr = hn::Set(kFloats, rows.radius[r]), power = hn::Set(kFloats, rows.power[r]);
    __mmask16 near[4] = {};
    for (std::size_t block = 0; block < kBlocks; ++block) {
      Vector sum = hn::MulAdd(px, x[block], start[block]);
      sum = hn::MulAdd(py, y[block], sum);
      sum = hn::MulAdd(pz, z[block], sum);
      sum = hn::MulAdd(pr, radius[block], sum);
      near[block] = hn::Gt(sum, power).raw;
    }
    const std::uint64_t candidates =
        kBlocks == 1 ? near[0] : _mm512_kunpackd(_mm512_kunpackw(near[3], near[2]), _mm512_kunpackw(near[1], near[0]));
    const std::size_t count = below < most ? below : most;
    std::uint64_t wanted = (~std::uint64_t{0} >> (64 - count)) & ~bits_at(ignored, ignored_words, bit);
    if (!kAllEnabled) {
      wanted &= tile.enabled_columns[word] & (0 - ((tile.enabled_rows[r / 64] >> (r % 64)) & 1U));
    }
    bit += first_column + below;  // the row's own number
    ++below;
    test_count += hwy::PopCount(wanted);
    if (kStoresWanted) {
      tile.wanted[r][word] = wanted;
    }
    const std::uint64_t kept = candidates & wanted;
    bits[r][word] = kept;
    hits[hit_count] = static_cast<std::uint8_t>(kTileWords * r + word);
    hit_count += kept != 0 ? 1 : 0;
  }
  found.tests = test_count;
  found.hits = hit_count;
}

// Rows with as many columns before them that they fill the same number of blocks are tested together.
template <bool kStoresWanted, bool kAllEnabled>
HWY_INLINE void find_in_registers(Tile& tile, float extent) {
  const Vector margin = hn::Set(Floats(), margin_of(extent));
  std::memset(tile.bits, 0, tile.row_count * sizeof tile.bits[0]);
  if (kStoresWanted) {
    std::memset(tile.wanted, 0, tile.row_count * sizeof tile.wanted[0]);
  }
  Found found{0, 0};
  for (std::size_t word = 0; 64 * word < tile.column_count; ++word) {
    const std::size_t columns_left = tile.column_count - 64 * word;
    const std::size_t blocks = columns_left < 64 ? (columns_left + kBlock - 1) / kBlock : 64 / kBlock;
    std::size_t r = first_row_of(tile, 64 * word);
    for (std::size_t block = 1; block <= blocks; ++block) {
      const std::size_t next = first_row_of(tile, 64 * word + block * kBlock);
      const std::size_t end = block == blocks || next > tile.row_count ? tile.row_count : next;
      if (r >= end) {
        continue;
      }
      switch (block) {
        case 1:
          test_rows<1, kStoresWanted, kAllEnabled>(tile, word, r, end, margin, tile.hits, found);
          break;
        case 2:
          test_rows<2, kStoresWanted, kAllEnabled>(tile, word, r, end, margin, tile.hits, found);
          break;
        case 3:
          test_rows<3, kStoresWanted, kAllEnabled>(tile, word, r, end, margin, tile.hits, found);
          break;
        default:
          test_rows<4, kStoresWanted, kAllEnabled>(tile, word, r, end, margin, tile.hits, found);
          break;
      }
      r = end;
    }
  }
  tile.test_count = found.tests;
  tile.hit_count = found.hits;
}

template <bool kStoresWanted>
HWY_INLINE void find_wanted(Tile& tile, float extent) {
  const std::uint64_t enabled =
      tile.enabled_columns[0] & tile.enabled_columns[1] & tile.enabled_rows[0] & tile.enabled_rows[1];
  if (~enabled == 0) {
    find_in_registers<kStoresWanted, true>(tile, extent);
  } else {
    find_in_registers<kStoresWanted, false>(tile, extent);
  }
}

#else

template <bool kStoresWanted>
HWY_INLINE void find_wanted(Tile& tile, float extent) {
  find_candidates(tile, extent);
  keep_wanted<kStoresWanted>(tile);
}

#endif

// The rule, as the header of the job states it.
HWY_INLINE bool overlap(const Sphere& p, const Sphere& q) {
  const float dx = p.x - q.x;
  const float dy = p.y - q.y;
  const float dz = p.z - q.z;
  const float s = p.radius + q.radius;
  const float squared_reach = s * s;
  return ((dx * dx + dy * dy) + dz * dz < squared_reach) & (squared_reach <= FLT_MAX);
}

// The words of `hits` that have bits left stay listed.
HWY_INLINE void keep_touching(Tile& tile) {
  const Sphere* const column_spheres = tile.column_spheres;
  const Sphere* const row_spheres = tile.row_spheres;
  std::uint64_t(*const bits)[kTileWords] = tile.bits;
  std::uint8_t* const hits = tile.hits;
  const std::size_t candidate_count = tile.hit_count;
  std::size_t hit_count = 0;
  for (std::size_t i = 0; i < candidate_count; ++i) {
    const std::size_t hit = hits[i], r = hit / kTileWords, word = hit % kTileWords;
    const Sphere row = row_spheres[r];
    std::uint64_t touching = 0;
    for (std::uint64_t left = bits[r][word]; left != 0; left &= left - 1) {
      const std::size_t column = hwy::Num0BitsBelowLS1Bit_Nonzero64(left);
      touching |= std::uint64_t{overlap(column_spheres[64 * word + column], row)} << column;
    }
    bits[r][word] = touching;
    hits[hit_count] = static_cast<std::uint8_t>(hit);
    hit_count += touching != 0 ? 1 : 0;
  }
  tile.hit_count = hit_count;
}

template <bool kStoresWanted>
HWY_INLINE void test_with(Tile& tile) {
  const float extent = tile.rows->extent > tile.columns->extent ? tile.rows->extent : tile.columns->extent;
  if (extent <= kMostExtent) {
    find_wanted<kStoresWanted>(tile, extent);
  } else {
    take_all_as_candidates(tile);
    keep_wanted<kStoresWanted>(tile);
  }
  keep_touching(tile);
}

void test(Tile& tile) {
  if (tile.wanted == nullptr) {
    test_with<false>(tile);
  } else {
    test_with<true>(tile);
  }
}

MaskedCount count(const Tile& tile, const std::uint64_t (&mask)[kTileWords]) {
  MaskedCount result;
  for (std::size_t half = 0; half < kTileWords; ++half) {
    for (std::uint64_t rows = mask[half]; rows != 0; rows &= rows - 1) {
      const std::size_t r = 64 * half + hwy::Num0BitsBelowLS1Bit_Nonzero64(rows);
      for (std::size_t word = 0; word <= half; ++word) {  // a row's columns are before it
        result.wanted += hwy::PopCount(tile.wanted[r][word] & mask[word]);
      }
    }
  }
  for (std::size_t i = 0; i < tile.hit_count; ++i) {
    const std::size_t r = tile.hits[i] / kTileWords, word = tile.hits[i] % kTileWords;
    const std::uint64_t row = 0 - ((mask[r / 64] >> (r % 64)) & 1U);
    result.touching += hwy::PopCount(tile.bits[r][word] & mask[word] & row);
  }
  return result;
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(fill);
SPHERECHAIN_KERNELS(test);
SPHERECHAIN_KERNELS(count);

}  // namespace

void fill_columns(Target resolved, const Sphere* spheres, std::size_t count, const Sphere& origin,
                  SphereColumns& columns) {
  fill_kernels[index_of(resolved)](spheres, count, origin, columns);
}

void test_tile(Target resolved, Tile& tile) { test_kernels[index_of(resolved)](tile); }

MaskedCount count_masked(Target resolved, const Tile& tile, const std::uint64_t (&mask)[kTileWords]) {
  return count_kernels[index_of(resolved)](tile, mask);
}

}  // namespace spherechain
#endif
