// SPDX-License-Identifier: MIT
// Spheres by coordinates, and which pairs of them may touch.
#include "runtime/src/simd/highway.h"

#if defined(SPHERECHAIN_PAIRS_SPHERE_COLUMNS_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_PAIRS_SPHERE_COLUMNS_H
#undef SPHERECHAIN_PAIRS_SPHERE_COLUMNS_H
#else
#define SPHERECHAIN_PAIRS_SPHERE_COLUMNS_H
#endif

#include <cfloat>

#include "runtime/src/pairs/sphere_registers.h"
#include "runtime/src/pairs/tile.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

// Spheres coordinate by coordinate, as vectors want them: seen from `origin`, with half of |center|^2, less radius^2
// and a margin for what tests may be off. The entries up to the next multiple of kBlock are there too, and are 0.
struct alignas(64) SphereColumns {
  float x[kTileSize], y[kTileSize], z[kTileSize], power[kTileSize];
};

// Share of a sphere's |center|^2 + radius^2 in the error bound of a test by multiply-adds: the proof is below.
constexpr float kMarginOfExtent = 0x1p-18F, kMinMargin = 0x1p-120F;

// The spheres of a whole vector. Returns what their extents raise the lanes of `extent` to.
template <typename D, typename V>
HWY_INLINE V fill_vector(D d, const Sphere* spheres, const Sphere& origin, V extent, SphereColumns& columns,
                         std::size_t i) {
  V x, y, z, radius;
  load_next_spheres(d, spheres, x, y, z, radius);
  x = hn::Sub(x, hn::Set(d, origin.x));
  y = hn::Sub(y, hn::Set(d, origin.y));
  z = hn::Sub(z, hn::Set(d, origin.z));
  const V squared_radius = hn::Mul(radius, radius);
  const V squared_length = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
  const V own = hn::Add(squared_length, squared_radius);
  const V margin = hn::MulAdd(hn::Set(d, kMarginOfExtent), own, hn::Set(d, kMinMargin));
  hn::StoreU(x, d, columns.x + i);
  hn::StoreU(y, d, columns.y + i);
  hn::StoreU(z, d, columns.z + i);
  hn::StoreU(hn::Sub(hn::Sub(hn::Mul(hn::Set(d, 0.5F), squared_length), squared_radius), margin), d, columns.power + i);
  // NaN becomes infinite, so that it stays.
  const V known = hn::IfThenElse(hn::Le(own, hn::Set(d, FLT_MAX)), own, hn::Inf(d));
  return hn::Max(extent, known);
}

// False where the extent of a sphere is not finite: then the columns are of no use.
HWY_INLINE bool fill_all(const Sphere* spheres, std::size_t count, const Sphere& origin, SphereColumns& columns) {
  constexpr hn::ScalableTag<float> kFloats;
  const std::size_t lanes = hn::Lanes(kFloats);
  auto extent = hn::Zero(kFloats);
  std::size_t i = 0;
  for (; i + lanes <= count; i += lanes) {
    extent = fill_vector(kFloats, spheres + i, origin, extent, columns, i);
  }
  const std::size_t whole = i;
  for (; i < count || i % kBlock != 0; i += lanes) {  // the lanes past the end are never asked for
    for (float* column : {columns.x, columns.y, columns.z, columns.power}) {
      hn::Store(hn::Zero(kFloats), kFloats, column + i);
    }
  }
  if (whole < count && count >= lanes) {
    extent = fill_vector(kFloats, spheres + (count - lanes), origin, extent, columns, count - lanes);
  } else if (whole < count) {
    Sphere rest[hn::MaxLanes(kFloats)];
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      rest[lane] = lane < count ? spheres[lane] : origin;
    }
    extent = fill_vector(kFloats, rest, origin, extent, columns, 0);
  }
  return hn::AllTrue(kFloats, hn::Le(extent, hn::Set(kFloats, FLT_MAX)));
}

// How much a pair's test below may be off. With p and q as the tile has them, h(p) = |p|^2 / 2 - rp^2 and u = 2^-24,
//   h(p) + h(q) - p.q = (|p - q|^2 - (rp + rq)^2) / 2 - (rp - rq)^2 / 2,
// which is below 0 where spheres touch; and little above it where they do not, as long as their radii are alike. With G
// at least |p|^2 + rp^2 of both spheres, computing it costs 14 u G at most: 2 for each h, 8 for the sum of products
// (fused or not: its parts are below 2 G, the products together below G), 1 for the comparison's side and 1 for terms
// of second order; moving the spheres to the tile's origin costs 4; and that the rule's own squares are rounded, by
// 8 u (rp + rq)^2 <= 32 u G, costs half of that; 2 that the margin is part of h. 36 u G in all. Each sphere brings 64
// of its own |p|^2 + rp^2, so that a pair's two are 64 u G at least; and 2^-120 for what underflows or is flushed to 0.
// So no pair is missed; what the rule then says no to are few. Nor is one missed for overflow, as long as G is finite:
// each h is, and where two spheres touch, -h(q) and some of the products are together at least rq^2 - G (px qx >= -(px
// - qx)^2 / 4, and so on). So sums overflow upwards, if at all.
//
// For kBlocks blocks of kBlock columns from `first` on, calls use(strip, bits) of each for the rows [begin, end), with
// at least the bits of the pairs that touch. Strips follow each other from `strip` on by block, and are `step` apart by
// row.
template <std::size_t kBlocks, typename Use>
HWY_INLINE void for_rows(const SphereColumns& columns, std::size_t first, const SphereColumns& rows, std::size_t begin,
                         std::size_t end, std::size_t strip, std::size_t step, const Use& use) {
  constexpr hn::ScalableTag<float> kFloats;
  using V = hn::Vec<hn::ScalableTag<float>>;
  constexpr std::size_t kLanes = hn::MaxLanes(kFloats);
  constexpr std::size_t kParts = kBlock / kLanes;
  V x[kBlocks][kParts], y[kBlocks][kParts], z[kBlocks][kParts], start[kBlocks][kParts];
  for (std::size_t block = 0; block < kBlocks; ++block) {
    for (std::size_t part = 0; part < kParts; ++part) {
      const std::size_t at = first + block * kBlock + part * kLanes;
      x[block][part] = hn::Load(kFloats, columns.x + at);
      y[block][part] = hn::Load(kFloats, columns.y + at);
      z[block][part] = hn::Load(kFloats, columns.z + at);
      start[block][part] = hn::Neg(hn::Load(kFloats, columns.power + at));
    }
  }
  for (std::size_t r = begin; r < end; ++r, strip += step) {
    const V px = hn::Set(kFloats, rows.x[r]);
    const V py = hn::Set(kFloats, rows.y[r]);
    const V pz = hn::Set(kFloats, rows.z[r]);
    const V power = hn::Set(kFloats, rows.power[r]);
    for (std::size_t block = 0; block < kBlocks; ++block) {
      std::uint64_t bits = 0;
      for (std::size_t part = 0; part < kParts; ++part) {
        V sum = hn::MulAdd(px, x[block][part], start[block][part]);
        sum = hn::MulAdd(py, y[block][part], sum);
        sum = hn::MulAdd(pz, z[block][part], sum);
        bits |= bits_of(hn::Gt(sum, power)) << (part * kLanes);
      }
      use(strip + block, static_cast<std::uint16_t>(bits));
    }
  }
}

// The same for all columns, a block's rows from first_row(first) on: by two blocks, row and block. Where registers are
// wide there are enough of them for two blocks, and what is loaded of a row serves both.
template <typename FirstRow, typename Use>
HWY_INLINE void for_candidates(const SphereColumns& columns, std::size_t column_count, const SphereColumns& rows,
                               std::size_t row_count, const FirstRow& first_row, const Use& use) {
  constexpr bool kIsWide = kListLanes == kBlock;
  std::size_t strip = 0;
  for (std::size_t first = 0; first < column_count; first += 2 * kBlock) {
    const std::size_t next = first + kBlock, begin = first_row(first);
    const std::size_t both = next < column_count && first_row(next) < row_count ? first_row(next) : row_count;
    for_rows<1>(columns, first, rows, begin, both, strip, 1, use);
    strip += begin < both ? both - begin : 0;
    if (kIsWide) {
      for_rows<kIsWide ? 2 : 1>(columns, first, rows, both, row_count, strip, 2, use);
    } else {
      for_rows<1>(columns, first, rows, both, row_count, strip, 2, use);
      for_rows<1>(columns, next, rows, both, row_count, strip + 1, 2, use);
    }
    strip += 2 * (row_count - both);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif
