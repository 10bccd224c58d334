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

// Lane i as bit i.
HWY_INLINE std::uint64_t bits_of(hn::Mask<Floats> mask) {
  constexpr Floats kFloats;
#if HWY_TARGET == HWY_AVX3
  std::uint16_t bits = 0;
#else
  std::uint8_t bits = 0;
#endif
  static_assert(hn::MaxLanes(kFloats) <= 8 * sizeof bits, "a bit a lane");
  hn::StoreMaskBits(kFloats, mask, reinterpret_cast<std::uint8_t*>(&bits));
  return bits;
}

// The spheres of a whole vector; true where one is huge.
HWY_INLINE bool fill_vector(const float* spheres, SphereColumns& columns, std::size_t i) {
  constexpr Floats kFloats;
  Vector x, y, z, radius;
  hn::LoadInterleaved4(kFloats, spheres, x, y, z, radius);
  hn::Store(x, kFloats, columns.x + i);
  hn::Store(y, kFloats, columns.y + i);
  hn::Store(z, kFloats, columns.z + i);
  hn::Store(radius, kFloats, columns.radius + i);
  return !hn::AllFalse(kFloats, hn::Gt(hn::Abs(radius), hn::Set(kFloats, kHugeRadius)));
}

bool fill(const Sphere* spheres, std::size_t count, SphereColumns& columns) {
  constexpr Floats kFloats;
  const std::size_t lanes = hn::Lanes(kFloats);
  bool any_huge = false;
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    any_huge |= fill_vector(&spheres[i].x, columns, i);
  }
  if (i < count) {
    Sphere rest[hn::MaxLanes(kFloats)] = {};  // the lanes past the end are never asked for
    std::memcpy(rest, spheres + i, (count - i) * sizeof(Sphere));
    any_huge |= fill_vector(&rest[0].x, columns, i);
  }
  return any_huge;
}

// The columns [first, first + count), at most 64, against one sphere. Bits from `count` on are anything.
template <bool kCheckFinite>
HWY_INLINE std::uint64_t test_row(const SphereColumns& columns, std::size_t first, std::size_t count, const Sphere& p) {
  constexpr Floats kFloats;
  const Vector px = hn::Set(kFloats, p.x);
  const Vector py = hn::Set(kFloats, p.y);
  const Vector pz = hn::Set(kFloats, p.z);
  const Vector pr = hn::Set(kFloats, p.radius);
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < count; i += hn::Lanes(kFloats)) {
    const Vector dx = hn::Sub(px, hn::Load(kFloats, columns.x + first + i));
    const Vector dy = hn::Sub(py, hn::Load(kFloats, columns.y + first + i));
    const Vector dz = hn::Sub(pz, hn::Load(kFloats, columns.z + first + i));
    const Vector s = hn::Add(pr, hn::Load(kFloats, columns.radius + first + i));
    const Vector squared_reach = hn::Mul(s, s);
    const Vector d2 = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
    hn::Mask<Floats> overlap = hn::Lt(d2, squared_reach);
    if (kCheckFinite) {
      overlap = hn::And(overlap, hn::Le(squared_reach, hn::Set(kFloats, FLT_MAX)));
    }
    bits |= bits_of(overlap) << i;
  }
  return bits;
}

// 64 bits from the `at`th on; those past the end are 0.
HWY_INLINE std::uint64_t bits_at(const std::uint64_t* words, std::size_t size, std::size_t at) {
  const std::size_t word = at / 64;
  const std::size_t shift = at % 64;
  const std::uint64_t next = word + 1 < size ? words[word + 1] : 0;
  return (words[word] >> shift) | ((next << 1) << (63 - shift));
}

template <bool kCheckFinite>
HWY_INLINE std::size_t test_rows(const Tile& tile) {
  std::size_t tests = 0;
  for (std::size_t r = 0; r < tile.row_count; ++r) {
    const std::size_t b = tile.first_row + r;
    const bool is_enabled = ((tile.enabled_rows[r / 64] >> (r % 64)) & 1U) != 0;
    // Of the pairs (a, b) only those with a < b.
    const std::size_t below = b > tile.first_column ? b - tile.first_column : 0;
    const std::size_t count = is_enabled ? (below < tile.column_count ? below : tile.column_count) : 0;
    for (std::size_t word = 0; word < kTileWords; ++word) {
      const std::size_t first = 64 * word;
      if (first >= count) {
        tile.bits[r][word] = 0;
        if (tile.wanted != nullptr) {
          tile.wanted[r][word] = 0;
        }
        continue;
      }
      const std::size_t in_word = count - first < 64 ? count - first : 64;
      std::uint64_t wanted = tile.enabled_columns[word] & (~std::uint64_t{0} >> (64 - in_word));
      wanted &= ~bits_at(tile.ignored, tile.ignored_words, b * (b - 1) / 2 + tile.first_column + first);
      tests += hwy::PopCount(wanted);
      if (tile.wanted != nullptr) {
        tile.wanted[r][word] = wanted;
      }
      tile.bits[r][word] = wanted & test_row<kCheckFinite>(*tile.columns, first, in_word, tile.rows[r]);
    }
  }
  return tests;
}

void test(Tile& tile) { tile.test_count = tile.any_huge ? test_rows<true>(tile) : test_rows<false>(tile); }

MaskedCount count(const Tile& tile, const std::uint64_t (&mask)[kTileWords]) {
  MaskedCount result;
  for (std::size_t half = 0; half < kTileWords; ++half) {
    for (std::uint64_t rows = mask[half]; rows != 0; rows &= rows - 1) {
      const std::size_t r = 64 * half + hwy::Num0BitsBelowLS1Bit_Nonzero64(rows);
      for (std::size_t word = 0; word <= half; ++word) {  // a row's columns are before it
        result.wanted += hwy::PopCount(tile.wanted[r][word] & mask[word]);
        result.touching += hwy::PopCount(tile.bits[r][word] & mask[word]);
      }
    }
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

bool fill_columns(Target resolved, const Sphere* spheres, std::size_t count, SphereColumns& columns) {
  return fill_kernels[index_of(resolved)](spheres, count, columns);
}

void test_tile(Target resolved, Tile& tile) { test_kernels[index_of(resolved)](tile); }

MaskedCount count_masked(Target resolved, const Tile& tile, const std::uint64_t (&mask)[kTileWords]) {
  return count_kernels[index_of(resolved)](tile, mask);
}

}  // namespace spherechain
#endif
