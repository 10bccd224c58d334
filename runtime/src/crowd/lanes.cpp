// SPDX-License-Identifier: MIT
#include "runtime/src/crowd/lanes.h"

#include <cfloat>

#include "runtime/src/base/arithmetic.h"
#include "runtime/src/base/pair_bits.h"
#include "runtime/src/simd/simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/src/crowd/lanes.cpp"
#include "runtime/src/pairs/sphere_columns.h"
#include "runtime/src/simd/highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

using Floats = hn::ScalableTag<float>;
using Vector = hn::Vec<Floats>;
using Numbers = hn::RebindToSigned<Floats>;

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

// From one instance after the other to one a lane, and seen from the first sphere. At least |center|^2 +
// radius^2 of each lane's spheres, seen so; infinite where one is not finite.
HWY_INLINE Vector prepare(const LaneBatch& batch) {
  constexpr Floats kFloats;
  constexpr std::size_t kLanes = hn::MaxLanes(kFloats);
  const Sphere* instances[kLanes];  // lanes of instances that are not there take after the last one
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    instances[lane] = batch.spheres + (lane < batch.count ? lane : batch.count - 1) * batch.stride;
  }
  Vector origin[3], extent = hn::Zero(kFloats);
  for (std::size_t i = 0; i < batch.sphere_count; ++i) {
    float* at = batch.lanes + kLaneFigures * kLanes * i;
    Vector center[3], radius;  // no LaneSphere: its own constructor would not be compiled for this target
    if (batch.spheres == nullptr) {
      for (std::size_t c = 0; c < 3; ++c) {
        center[c] = hn::Load(kFloats, at + c * kLanes);
      }
      radius = hn::Load(kFloats, at + 3 * kLanes);
    } else {
      load_spheres(
          kFloats, [&](std::size_t lane) -> const Sphere& { return instances[lane][i]; }, center[0], center[1],
          center[2], radius);
    }
    hn::Store(radius, kFloats, at + 3 * kLanes);
    for (std::size_t c = 0; c < 3; ++c) {
      hn::Store(center[c], kFloats, at + c * kLanes);
      if (i == 0) {
        origin[c] = center[c];
      }
      center[c] = hn::Sub(center[c], origin[c]);
      hn::Store(center[c], kFloats, at + (4 + c) * kLanes);
    }
    const Vector squared_radius = hn::Mul(radius, radius);
    const Vector squared_length =
        hn::Add(hn::Add(hn::Mul(center[0], center[0]), hn::Mul(center[1], center[1])), hn::Mul(center[2], center[2]));
    hn::Store(hn::Sub(squared_radius, hn::Mul(hn::Set(kFloats, 0.5F), squared_length)), kFloats, at + 7 * kLanes);
    const Vector own = hn::Add(squared_length, squared_radius);
    extent = hn::Max(extent, hn::IfThenElse(hn::Le(own, hn::Set(kFloats, FLT_MAX)), own, hn::Inf(kFloats)));
  }
  return extent;
}

// Where the spheres overlap, and are within rest_scale of each other: a rest_scale of 1 is none.
HWY_INLINE hn::Mask<Floats> overlap(const LaneSphere& p, const LaneSphere& q, float rest_scale) {
  constexpr Floats kFloats;
  const Vector dx = hn::Sub(p.x, q.x);
  const Vector dy = hn::Sub(p.y, q.y);
  const Vector dz = hn::Sub(p.z, q.z);
  const Vector s = hn::Add(p.radius, q.radius);
  const Vector d2 = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
  const Vector t = hn::Mul(hn::Set(kFloats, rest_scale), s);
  return hn::And(hn::Lt(d2, hn::Mul(t, t)), hn::Le(hn::Mul(s, s), hn::Set(kFloats, FLT_MAX)));
}

// The results of each lane's instance.
struct Found {
  LaneBatch& batch;
  hn::Mask<Floats> in_use;
  hn::Vec<Numbers> counts, lists;  // of pairs; where in the batch's lists the lane's own starts
  bool tests_all;                  // wanted pairs, for which there are no candidates
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
HWY_INLINE void test_row(Found& found, const Row& row, std::size_t& next_rest_pair) {
  const LaneBatch& batch = found.batch;
  const LaneSphere own = load(batch.lanes, row.a);
  for (std::size_t first = row.a + 1; first < batch.sphere_count; first += 64) {
    const std::uint64_t own_rest_pairs =
        sorted_row_bits(batch.is_rest_pair, batch.bit_words, row.a, first, batch.sphere_count);
    std::uint64_t left = sorted_row_bits(batch.wanted, batch.bit_words, row.a, first, batch.sphere_count);
    if (!found.tests_all) {
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
      report(found, overlap(own, load(batch.lanes, b), *rest_scale), row.a, b);
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
HWY_INLINE void find_pairs(Found& found, Vector margin) {
  const LaneBatch& batch = found.batch;
  const std::size_t row_size = candidate_row(batch.sphere_count);
  for (std::size_t i = 0; i < 2 * row_size; ++i) {
    batch.candidates[i] = 0;  // narrow targets write half of them
  }
  std::size_t next_rest_pair = 0;
  for (std::size_t a = 0; a + 1 < batch.sphere_count; a += 2) {
    const Row low{a, batch.candidates}, high{a + 1, batch.candidates + row_size};
    if (!found.tests_all) {
      find_candidates(batch, margin, low, high);
    }
    test_row(found, low, next_rest_pair);
    test_row(found, high, next_rest_pair);
  }
}

void test_batch(LaneBatch& batch) {
  constexpr Floats kFloats;
  constexpr Numbers kNumbers;
  const Vector extent = prepare(batch);
  Found found{batch, hn::FirstN(kFloats, batch.count), hn::Zero(kNumbers),
              hn::Mul(hn::Iota(kNumbers, 0), hn::Set(kNumbers, kMaxListed + 1)),
              !hn::AllTrue(kFloats, hn::Le(extent, hn::Set(kFloats, FLT_MAX)))};
  find_pairs(found, hn::Add(hn::Mul(hn::Set(kFloats, kMarginOfExtent), extent), hn::Set(kFloats, kMinMargin)));
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
