// SPDX-License-Identifier: MIT
#include "crowd/lanes.h"

#include <cfloat>

#include "pairs/overlap.h"
#include "pairs/pair_bits.h"
#include "simd/arithmetic.h"
#include "simd/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "crowd/lanes.cpp"
#include "pairs/sphere_registers.h"
#include "simd/highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::ScalableTag<float>;
using Vector = hn::Vec<Floats>;
using Numbers = hn::RebindToSigned<Floats>;

// Two radii up to this have a sum whose square is finite.
constexpr float kHugeRadius = 9e18F;

struct LaneSphere {
  Vector x, y, z, radius;
};

HWY_INLINE LaneSphere load(const float* lanes, std::size_t sphere) {
  constexpr Floats kFloats;
  const std::size_t n = hn::Lanes(kFloats);
  const float* at = lanes + kLaneFigures * n * sphere;
  return {hn::Load(kFloats, at), hn::Load(kFloats, at + n), hn::Load(kFloats, at + 2 * n),
          hn::Load(kFloats, at + 3 * n)};
}

// From one instance after the other to one a lane, padded, and seen from the first sphere. At least |center|^2 +
// radius^2 of each lane's spheres, seen so; infinite where one is not finite. `any_huge`: a radius is huge.
HWY_INLINE Vector prepare(const LaneBatch& batch, bool& any_huge) {
  constexpr Floats kFloats;
  const std::size_t n = hn::Lanes(kFloats);
  Sphere row[hn::MaxLanes(kFloats)] = {};
  any_huge = false;
  Vector origin[3], extent = hn::Zero(kFloats);
  for (std::size_t i = 0; i < batch.sphere_count; ++i) {
    float* at = batch.lanes + kLaneFigures * n * i;
    Vector x, y, z, radius;  // no LaneSphere: its own constructor would not be compiled for this target
    if (batch.spheres == nullptr) {
      x = hn::Load(kFloats, at);
      y = hn::Load(kFloats, at + n);
      z = hn::Load(kFloats, at + 2 * n);
      radius = hn::Load(kFloats, at + 3 * n);
    } else {
      const Sphere* const first = batch.spheres + i;
      const std::size_t stride = batch.stride;
      if (batch.count == n) {
        load_spheres(
            kFloats, [&](std::size_t lane) -> const Sphere& { return first[lane * stride]; }, x, y, z, radius);
      } else {
        for (std::size_t lane = 0; lane < batch.count; ++lane) {
          row[lane] = first[lane * stride];
        }
        load_spheres(
            kFloats, [&](std::size_t lane) -> const Sphere& { return row[lane]; }, x, y, z, radius);
      }
      hn::Store(x, kFloats, at);
      hn::Store(y, kFloats, at + n);
      hn::Store(z, kFloats, at + 2 * n);
    }
    if (batch.padding != nullptr) {
      radius = hn::Add(radius, hn::Set(kFloats, batch.padding[i]));
      radius = hn::IfThenElse(hn::Lt(radius, hn::Zero(kFloats)), hn::NaN(kFloats), radius);  // as padded_radius.h
    }
    any_huge |= !hn::AllFalse(kFloats, hn::Gt(hn::Abs(radius), hn::Set(kFloats, kHugeRadius)));
    hn::Store(radius, kFloats, at + 3 * n);
    if (i == 0) {
      origin[0] = x;
      origin[1] = y;
      origin[2] = z;
    }
    x = hn::Sub(x, origin[0]);
    y = hn::Sub(y, origin[1]);
    z = hn::Sub(z, origin[2]);
    const Vector squared_radius = hn::Mul(radius, radius);
    const Vector squared_length = hn::Add(hn::Add(hn::Mul(x, x), hn::Mul(y, y)), hn::Mul(z, z));
    hn::Store(x, kFloats, at + 4 * n);
    hn::Store(y, kFloats, at + 5 * n);
    hn::Store(z, kFloats, at + 6 * n);
    hn::Store(hn::Sub(squared_radius, hn::Mul(hn::Set(kFloats, 0.5F), squared_length)), kFloats, at + 7 * n);
    const Vector own = hn::Add(squared_length, squared_radius);
    extent = hn::Max(extent, hn::IfThenElse(hn::Le(own, hn::Set(kFloats, FLT_MAX)), own, hn::Inf(kFloats)));
  }
  return extent;
}

// Where the spheres overlap, and are within rest_scale of each other: a rest_scale of 1 is none.
template <bool kCheckFinite>
HWY_INLINE hn::Mask<Floats> overlap(const LaneSphere& p, const LaneSphere& q, float rest_scale) {
  constexpr Floats kFloats;
  const Vector dx = hn::Sub(p.x, q.x);
  const Vector dy = hn::Sub(p.y, q.y);
  const Vector dz = hn::Sub(p.z, q.z);
  const Vector s = hn::Add(p.radius, q.radius);
  const Vector d2 = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
  const Vector t = hn::Mul(hn::Set(kFloats, rest_scale), s);
  const hn::Mask<Floats> touching = hn::Lt(d2, hn::Mul(t, t));
  return kCheckFinite ? hn::And(touching, hn::Le(hn::Mul(s, s), hn::Set(kFloats, FLT_MAX))) : touching;
}

// What is found of each lane's instance.
struct Found {
  LaneBatch& batch;
  hn::Mask<Floats> in_use;
  hn::Vec<Numbers> counts, lists;  // of pairs; where in the batch's lists the lane's own starts
};

// All lanes write, without a branch: those that do not touch write what the next pair, or nobody, overwrites.
HWY_INLINE void report(Found& found, hn::Mask<Floats> touching, std::size_t a, std::size_t b) {
  constexpr Numbers kNumbers;
  const auto own = hn::RebindMask(kNumbers, hn::And(touching, found.in_use));
  const auto place = hn::Add(found.lists, hn::Min(found.counts, hn::Set(kNumbers, kMaxListed)));
  hn::ScatterIndex(hn::Set(kNumbers, static_cast<std::int32_t>(a << 16 | b)), kNumbers,
                   reinterpret_cast<std::int32_t*>(found.batch.listed[0]), place);
  found.counts = hn::Sub(found.counts, hn::VecFromMask(kNumbers, own));
  if (found.batch.bits != nullptr) {
    const std::size_t bit = b * (b - 1) / 2 + a;
    for (std::uint64_t left = bits_of(hn::And(touching, found.in_use)); left != 0; left &= left - 1) {
      const std::size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero64(left);
      found.batch.bits[lane * found.batch.bit_words + bit / 64] |= std::uint64_t{1} << (bit % 64);
    }
  }
}

// Which of 64 numbers are not 0.
HWY_INLINE std::uint64_t any_bits(const std::uint16_t* numbers) {
  const hn::ScalableTag<std::uint16_t> d;
  std::uint64_t out = 0;
  for (std::size_t i = 0; i < 64; i += hn::Lanes(d)) {
    std::uint64_t bits = 0;
    hn::StoreMaskBits(d, hn::Ne(hn::LoadU(d, numbers + i), hn::Zero(d)), reinterpret_cast<std::uint8_t*>(&bits));
    out |= bits << i;
  }
  return out;
}

// A row of the table of pairs: sphere `a` and those after it.
struct Row {
  std::size_t a;
  std::uint16_t* candidates;  // of each sphere after `a` with which it is wanted: a bit a lane
};

// Tests a row's pairs that are candidates in any lane, in order. `next_rest_pair`: the first rest pair of the row, then
// of the next one.
template <bool kCheckFinite>
HWY_INLINE void test_row(Found& found, const Row& row, std::size_t& next_rest_pair) {
  const LaneBatch& batch = found.batch;
  const LaneSphere own = load(batch.lanes, row.a);
  for (std::size_t first = row.a + 1; first < batch.sphere_count; first += 64) {
    const std::uint64_t own_rest_pairs =
        sorted_row_bits(batch.is_rest_pair, batch.bit_words, row.a, first, batch.sphere_count);
    std::uint64_t left = sorted_row_bits(batch.wanted, batch.bit_words, row.a, first, batch.sphere_count);
    if (!kCheckFinite) {
      left &= any_bits(row.candidates + first);
    }
    for (; left != 0; left &= left - 1) {
      const std::uint64_t lowest = left & (~left + 1);
      const std::size_t b = first + hwy::Num0BitsBelowLS1Bit_Nonzero64(left);
      constexpr float kNoScale = 1;
      const float* rest_scale = &kNoScale;
      if ((own_rest_pairs & lowest) != 0) {
        rest_scale = &batch.rest_pairs.data[next_rest_pair + hwy::PopCount(own_rest_pairs & (lowest - 1))].rest_scale;
      }
      report(found, overlap<kCheckFinite>(own, load(batch.lanes, b), *rest_scale), row.a, b);
    }
    next_rest_pair += hwy::PopCount(own_rest_pairs);
  }
}

// A sphere as candidates are found by: what its lanes' least sum is.
struct Seen {
  Vector x, y, z, least;
};

HWY_INLINE hn::Mask<Floats> is_candidate(const Seen& own, Vector x, Vector y, Vector z, Vector start) {
  return hn::Gt(hn::MulAdd(own.z, z, hn::MulAdd(own.y, y, hn::MulAdd(own.x, x, start))), own.least);
}

// The candidates of two rows that follow each other, so that what is loaded of a sphere serves both: as a tile's, three
// multiply-adds with a margin for what they may be off.
HWY_INLINE void find_candidates(const LaneBatch& batch, Vector margin, const Row& low, const Row& high) {
  constexpr Floats kFloats;
  const std::size_t n = hn::Lanes(kFloats);
  const auto seen = [&](std::size_t i) HWY_ATTR {
    const float* const own = batch.lanes + kLaneFigures * n * i;
    return Seen{hn::Load(kFloats, own + 4 * n), hn::Load(kFloats, own + 5 * n), hn::Load(kFloats, own + 6 * n),
                hn::Sub(hn::Neg(hn::Load(kFloats, own + 7 * n)), margin)};
  };
  const Seen of_low = seen(low.a), of_high = seen(high.a);
  for (std::size_t first = low.a + 1; first < batch.sphere_count; first += 64) {
    std::uint64_t left = sorted_row_bits(batch.wanted, batch.bit_words, low.a, first, batch.sphere_count) |
                         sorted_row_bits(batch.wanted, batch.bit_words, high.a, first, batch.sphere_count);
    for (; left != 0; left &= left - 1) {
      const std::size_t b = first + hwy::Num0BitsBelowLS1Bit_Nonzero64(left);
      const float* const other = batch.lanes + kLaneFigures * n * b;
      const Vector x = hn::Load(kFloats, other + 4 * n), y = hn::Load(kFloats, other + 5 * n),
                   z = hn::Load(kFloats, other + 6 * n), start = hn::Load(kFloats, other + 7 * n);
      hn::StoreMaskBits(kFloats, is_candidate(of_low, x, y, z, start),
                        reinterpret_cast<std::uint8_t*>(low.candidates + b));
      hn::StoreMaskBits(kFloats, is_candidate(of_high, x, y, z, start),
                        reinterpret_cast<std::uint8_t*>(high.candidates + b));
    }
  }
}

// In the order of sorted pairs, so that each lane's list is in order. Where a figure is not finite or too large, all
// wanted pairs are tested by the rule.
template <bool kCheckFinite>
HWY_INLINE void find_pairs(Found& found, Vector margin) {
  const LaneBatch& batch = found.batch;
  const std::size_t row_size = candidate_row(batch.sphere_count);
  for (std::size_t i = 0; i < 2 * row_size; ++i) {
    batch.candidates[i] = 0;  // narrow targets write half of them
  }
  std::size_t next_rest_pair = 0;
  for (std::size_t a = 0; a + 1 < batch.sphere_count; a += 2) {
    const Row low{a, batch.candidates}, high{a + 1, batch.candidates + row_size};
    if (!kCheckFinite) {
      find_candidates(batch, margin, low, high);
    }
    test_row<kCheckFinite>(found, low, next_rest_pair);
    test_row<kCheckFinite>(found, high, next_rest_pair);
  }
}

void test_batch(LaneBatch& batch) {
  constexpr Floats kFloats;
  constexpr Numbers kNumbers;
  bool any_huge = false;
  const Vector extent = prepare(batch, any_huge);
  Found found{batch, hn::FirstN(kFloats, batch.count), hn::Zero(kNumbers),
              hn::Mul(hn::Iota(kNumbers, 0), hn::Set(kNumbers, kMaxListed + 1))};
  if (!any_huge && hn::AllTrue(kFloats, hn::Le(extent, hn::Set(kFloats, FLT_MAX)))) {
    find_pairs<false>(found, hn::Add(hn::Mul(hn::Set(kFloats, kMarginOfExtent), extent), hn::Set(kFloats, kMinMargin)));
  } else {
    find_pairs<true>(found, hn::Zero(kFloats));
  }
  hn::StoreU(found.counts, kNumbers, reinterpret_cast<std::int32_t*>(batch.pair_counts));
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(test_batch);

}  // namespace

void test_lanes(Target resolved, LaneBatch& batch) { test_batch_kernels[index_of(resolved)](batch); }

}  // namespace spherechain
#endif
