// SPDX-License-Identifier: MIT
#include "overlap.h"

#include <cfloat>
#include <cstring>

#include "arithmetic.h"
#include "simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "overlap.cpp"
#include "highway.h"
#include "sphere_registers.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::ScalableTag<float>;
using Vector = hn::Vec<Floats>;

// The spheres of a whole vector. Returns what their extents raise the lanes of `extent` to.
HWY_INLINE Vector fill_vector(const Sphere* spheres, const Sphere& origin, Vector extent, SphereColumns& columns,
                              std::size_t i) {
  constexpr Floats kFloats;
  Vector x, y, z, radius;
  load_spheres(
      kFloats, [&](std::size_t k) -> const Sphere& { return spheres[k]; }, x, y, z, radius);
  x = hn::Sub(x, hn::Set(kFloats, origin.x));
  y = hn::Sub(y, hn::Set(kFloats, origin.y));
  z = hn::Sub(z, hn::Set(kFloats, origin.z));
  const Vector squared_radius = hn::Mul(radius, radius);
  const Vector squared_length = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
  hn::StoreU(x, kFloats, columns.x + i);
  hn::StoreU(y, kFloats, columns.y + i);
  hn::StoreU(z, kFloats, columns.z + i);
  hn::StoreU(hn::Sub(hn::Mul(hn::Set(kFloats, 0.5F), squared_length), squared_radius), kFloats, columns.power + i);
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
    extent = fill_vector(spheres + i, origin, extent, columns, i);
  }
  const std::size_t whole = i;
  for (; i < count || i % kBlock != 0; i += lanes) {  // the lanes past the end are never asked for
    for (float* column : {columns.x, columns.y, columns.z, columns.power}) {
      hn::Store(hn::Zero(kFloats), kFloats, column + i);
    }
  }
  if (whole < count && count >= lanes) {
    extent = fill_vector(spheres + (count - lanes), origin, extent, columns, count - lanes);
  } else if (whole < count) {
    Sphere rest[hn::MaxLanes(kFloats)];
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      rest[lane] = lane < count ? spheres[lane] : origin;
    }
    extent = fill_vector(rest, origin, extent, columns, 0);
  }
  columns.extent = hn::GetLane(hn::MaxOfLanes(kFloats, extent));
}

// How much a pair's test below may be off. With p and q as the tile has them, h(p) = |p|^2 / 2 - rp^2 and u = 2^-24,
//   h(p) + h(q) - p.q = (|p - q|^2 - (rp + rq)^2) / 2 - (rp - rq)^2 / 2,
// which is below 0 where spheres touch; and little above it where they do not, as long as their radii are alike. With G
// at least |p|^2 + rp^2 of every sphere, computing it costs 14 u G at most: 2 for each h, 8 for the sum of products
// (fused or not: its parts are below 2 G, the products together below G), 1 for the comparison's side and 1 for terms
// of second order; moving the spheres to the tile's origin costs 4; and that the rule's own squares are rounded, by
// 8 u (rp + rq)^2 <= 32 u G, costs half of that. 34 u G in all, of which we allow 64; and 2^-120 for what underflows or
// is flushed to 0. So no pair is missed; what the rule then says no to are few.
// Nor is one missed for overflow, as long as G is finite: each h is, and where two spheres touch, -h(q) and some of the
// products are together at least rq^2 - G (px qx >= -(px - qx)^2 / 4, and so on). So sums overflow upwards, if at all.
HWY_INLINE float margin_of(float extent) { return kMarginOfExtent * extent + kLeastMargin; }

// Sets at least the bits of the pairs that touch; and of other pairs, some of the columns after the row too.
HWY_INLINE void find_candidates(const Tile& tile, float extent) {
  constexpr Floats kFloats;
  constexpr std::size_t kLanes = hn::MaxLanes(kFloats);
  constexpr std::size_t kParts = kBlock / kLanes;
  const SphereColumns& columns = *tile.columns;
  const SphereColumns& rows = *tile.rows;
  const Vector margin = hn::Set(kFloats, margin_of(extent));
  const std::size_t row_count = tile.place.row_count;
  for (std::size_t first = 0; first < tile.place.column_count; first += kBlock) {
    Vector x[kParts], y[kParts], z[kParts], start[kParts];
    for (std::size_t part = 0; part < kParts; ++part) {
      const std::size_t at = first + part * kLanes;
      x[part] = hn::Load(kFloats, columns.x + at);
      y[part] = hn::Load(kFloats, columns.y + at);
      z[part] = hn::Load(kFloats, columns.z + at);
      start[part] = hn::Sub(margin, hn::Load(kFloats, columns.power + at));
    }
    auto* out = reinterpret_cast<std::uint8_t*>(tile.bits) + first / 8;
    for (std::size_t r = first_row_of(tile.place, first); r < row_count; ++r) {
      const Vector px = hn::Set(kFloats, rows.x[r]);
      const Vector py = hn::Set(kFloats, rows.y[r]);
      const Vector pz = hn::Set(kFloats, rows.z[r]);
      const Vector power = hn::Set(kFloats, rows.power[r]);
      std::uint64_t bits = 0;
      for (std::size_t part = 0; part < kParts; ++part) {
        Vector sum = hn::MulAdd(px, x[part], start[part]);
        sum = hn::MulAdd(py, y[part], sum);
        sum = hn::MulAdd(pz, z[part], sum);
        bits |= bits_of(hn::Gt(sum, power)) << (part * kLanes);
      }
      const auto block = static_cast<std::uint16_t>(bits);
      std::memcpy(out + r * sizeof(TileWords), &block, sizeof block);
    }
  }
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
  for (std::size_t i = 0; i < count; i += kLanes) {
    const auto kept = hn::And(hn::LoadU(kWords, bits + i), hn::LoadU(kWords, plain + i));
    hn::StoreU(kept, kWords, bits + i);
    std::uint8_t mask[8] = {};
    hn::StoreMaskBits(kWords, hn::Ne(kept, hn::Zero(kWords)), mask);
    out.words[i / 64] |= std::uint64_t{mask[0]} << (i % 64);
  }
  return out;
}

// Tests pairs by the rule: a is a column's number, b a row's. Those that touch and are wanted get their bits.
class Listing {
 public:
  HWY_INLINE explicit Listing(Tile& tile) : tile_(tile) {}

  // kListLanes pairs, those of them whose bits are in `lanes`.
  HWY_INLINE void test(const NearPair* pairs, std::uint64_t lanes) {
    std::uint64_t left = test_listed(tile_.column_spheres, tile_.row_spheres, pairs) & lanes;
    for (; left != 0; left &= left - 1) {
      const NearPair& pair = pairs[hwy::Num0BitsBelowLS1Bit_Nonzero64(left)];
      const std::size_t word = pair.a / 64;
      const std::uint64_t bit = tile_.wanted[pair.b].words[word] & (std::uint64_t{1} << (pair.a % 64));
      tile_.bits[pair.b].words[word] |= bit;
      hits_.words[pair.b / 32] |= std::uint64_t{bit != 0} << (kTileWords * (pair.b % 32) + word);
    }
  }

  // One by one: tested when there are enough of them, or at the end.
  HWY_INLINE void add(std::uint32_t a, std::uint32_t b, float reach) {
    pairs_[count_].a = a;
    pairs_[count_].b = b;
    pairs_[count_].reach = reach;
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
  NearPair pairs_[kListLanes];
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

HWY_INLINE void test_near(const Tile& tile, Listing& listing) {
  const TilePlace place = tile.place;
  const NearPair* const near = tile.near.data;
  const std::size_t near_count = tile.near.size;
  std::size_t i = 0;
  if (tile.is_whole) {
    for (; i + kListLanes <= near_count; i += kListLanes) {
      listing.test(near + i, ~std::uint64_t{0});
    }
  }
  for (; i < near_count; ++i) {
    const auto column = static_cast<std::uint32_t>(near[i].a - place.first_column),
               row = static_cast<std::uint32_t>(near[i].b - place.first_row);
    if (row < place.row_count) {
      listing.add(column, row, near[i].reach);
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
  const float extent = tile.rows->extent > tile.columns->extent ? tile.rows->extent : tile.columns->extent;
  if (extent <= FLT_MAX) {
    std::memset(static_cast<void*>(tile.bits), 0, padded_rows(tile.place.row_count) * sizeof(TileWords));
    find_candidates(tile, extent);
  } else {
    std::memset(static_cast<void*>(tile.bits), 0xFF, padded_rows(tile.place.row_count) * sizeof(TileWords));
  }
  Listing listing(tile);
  test_candidates(tile, keep_plain(tile), listing);
  test_near(tile, listing);
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
