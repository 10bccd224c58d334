// SPDX-License-Identifier: MIT
#include "crowd_lanes.h"

#include <cfloat>

#include "arithmetic.h"
#include "overlap.h"
#include "simd.h"
#include "triangle_bits.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "crowd_lanes.cpp"
#include "highway.h"
#include "sphere_registers.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::ScalableTag<float>;
using Vector = hn::Vec<Floats>;

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

// A bit a lane: where the spheres overlap, and are within reach of each other.
template <bool kCheckFinite, bool kNear>
HWY_INLINE std::uint64_t overlap(const LaneSphere& p, const LaneSphere& q, float reach) {
  constexpr Floats kFloats;
  const Vector dx = hn::Sub(p.x, q.x);
  const Vector dy = hn::Sub(p.y, q.y);
  const Vector dz = hn::Sub(p.z, q.z);
  const Vector s = hn::Add(p.radius, q.radius);
  const Vector squared_reach = hn::Mul(s, s);
  const Vector d2 = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
  hn::Mask<Floats> touching = hn::Lt(d2, squared_reach);
  if (kCheckFinite) {
    touching = hn::And(touching, hn::Le(squared_reach, hn::Set(kFloats, FLT_MAX)));
  }
  if (kNear) {
    const Vector t = hn::Mul(hn::Set(kFloats, reach), s);
    touching = hn::And(touching, hn::Lt(d2, hn::Mul(t, t)));
  }
  return bits_of(touching);
}

// Few lanes touch: each on its own.
HWY_INLINE void report(LaneBatch& batch, std::uint64_t lanes, std::uint32_t a, std::uint32_t b) {
  const std::size_t below = b;
  const std::size_t bit = below * (below - 1) / 2 + a;
  for (; lanes != 0; lanes &= lanes - 1) {
    const std::size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero64(lanes);
    batch.bits[lane * batch.bit_words + bit / 64] |= std::uint64_t{1} << (bit % 64);
    batch.listed[lane][batch.pair_counts[lane]++ % kMostListed] = a << 16 | b;
  }
}

// A sphere as candidates are found by: what its lanes' least sum is.
struct Row {
  Vector x, y, z, least;
};

HWY_INLINE Vector sum_of(Vector x, Vector y, Vector z, Vector start, const Row& row) {
  return hn::MulAdd(row.z, z, hn::MulAdd(row.y, y, hn::MulAdd(row.x, x, start)));
}

// All wanted pairs but near ones: as a tile's, first three multiply-adds with a margin for what they may be off. Two
// rows of the table at a time, so that half the columns are loaded; few of the pairs are candidates.
HWY_INLINE void find_touching(LaneBatch& batch, Vector margin) {
  constexpr Floats kFloats;
  const std::size_t n = hn::Lanes(kFloats), sphere_count = batch.sphere_count, bit_words = batch.bit_words;
  const std::uint64_t in_use = (std::uint64_t{1} << batch.count) - 1;
  const float* const lanes = batch.lanes;
  const std::uint64_t* const wanted = batch.wanted;
  const auto load_row = [&](std::size_t b) HWY_ATTR {
    const float* const own = lanes + kLaneFigures * n * b;
    return Row{hn::Load(kFloats, own + 4 * n), hn::Load(kFloats, own + 5 * n), hn::Load(kFloats, own + 6 * n),
               hn::Sub(hn::Neg(hn::Load(kFloats, own + 7 * n)), margin)};
  };
  const auto test = [&](std::size_t a, std::size_t b) HWY_ATTR {
    report(batch, in_use & overlap<false, false>(load(lanes, a), load(lanes, b), 1.0F), static_cast<std::uint32_t>(a),
           static_cast<std::uint32_t>(b));
  };
  for (std::size_t b = 1; b < sphere_count; b += 2) {
    const std::size_t next = b + 1 < sphere_count ? b + 1 : b;
    const Row low = load_row(b), high = load_row(next);
    for (std::size_t first = 0; first < next; first += 64) {
      const std::uint64_t of_low = row_bits(wanted, bit_words, first, b),
                          of_high = next == b ? 0 : row_bits(wanted, bit_words, first, next);
      for (std::uint64_t left = of_low | of_high; left != 0; left &= left - 1) {
        const std::size_t i = hwy::Num0BitsBelowLS1Bit_Nonzero64(left), a = first + i;
        const float* const other = lanes + kLaneFigures * n * a;
        const Vector x = hn::Load(kFloats, other + 4 * n), y = hn::Load(kFloats, other + 5 * n),
                     z = hn::Load(kFloats, other + 6 * n), start = hn::Load(kFloats, other + 7 * n);
        const auto is_low = hn::Gt(sum_of(x, y, z, start, low), low.least),
                   is_high = hn::Gt(sum_of(x, y, z, start, high), high.least);
        if (HWY_UNLIKELY(!hn::AllFalse(kFloats, hn::Or(is_low, is_high)))) {
          if (((of_low >> i) & 1U) != 0 && !hn::AllFalse(kFloats, is_low)) {
            test(a, b);
          }
          if (((of_high >> i) & 1U) != 0 && !hn::AllFalse(kFloats, is_high)) {
            test(a, next);
          }
        }
      }
    }
  }
}

// The same by the rule alone, for what is too large or not finite.
HWY_INLINE void find_touching_by_rule(LaneBatch& batch) {
  const std::uint64_t in_use = (std::uint64_t{1} << batch.count) - 1;
  std::size_t bit = 0;
  for (std::uint32_t b = 1; b < batch.sphere_count; ++b) {
    for (std::uint32_t a = 0; a < b; ++a, ++bit) {
      if (((batch.wanted[bit / 64] >> (bit % 64)) & 1U) != 0) {
        report(batch, in_use & overlap<true, false>(load(batch.lanes, a), load(batch.lanes, b), 1.0F), a, b);
      }
    }
  }
}

template <bool kCheckFinite>
HWY_INLINE void find_near(LaneBatch& batch) {
  const std::uint64_t in_use = (std::uint64_t{1} << batch.count) - 1;
  for (std::size_t i = 0; i < batch.near.size; ++i) {
    const NearPair& near = batch.near[i];
    if (((batch.near_wanted[i / 64] >> (i % 64)) & 1U) != 0) {
      const std::uint64_t lanes =
          in_use & overlap<kCheckFinite, true>(load(batch.lanes, near.a), load(batch.lanes, near.b), near.reach);
      report(batch, lanes, near.a, near.b);
    }
  }
}

void test_batch(LaneBatch& batch) {
  constexpr Floats kFloats;
  for (std::uint32_t& count : batch.pair_counts) {
    count = 0;
  }
  bool any_huge = false;
  const Vector extent = prepare(batch, any_huge);
  if (!any_huge && hn::AllTrue(kFloats, hn::Le(extent, hn::Set(kFloats, FLT_MAX)))) {
    find_touching(batch, hn::Add(hn::Mul(hn::Set(kFloats, kMarginOfExtent), extent), hn::Set(kFloats, kLeastMargin)));
    find_near<false>(batch);
  } else {
    find_touching_by_rule(batch);
    find_near<true>(batch);
  }
}

// Each pair's place is the number of those before it.
void order(const std::uint32_t* listed, std::size_t count, std::uint32_t instance, CrowdPair* out, std::size_t room) {
  const hn::ScalableTag<std::uint32_t> kPairs;
  for (std::size_t i = 0; i < count; ++i) {
    const auto own = hn::Set(kPairs, listed[i]);
    std::size_t place = 0;
    for (std::size_t k = 0; k < count; k += hn::MaxLanes(kPairs)) {
      const auto before = hn::Lt(hn::LoadU(kPairs, listed + k), own);
      place += hn::CountTrue(kPairs, hn::And(before, hn::FirstN(kPairs, count - k)));
    }
    if (place < room) {
      out[place].instance = instance;
      out[place].pair.a = listed[i] >> 16;
      out[place].pair.b = listed[i] & 0xFFFFU;
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(test_batch);
SPHERECHAIN_KERNELS(order);

}  // namespace

void test_lanes(Target resolved, LaneBatch& batch) { test_batch_kernels[index_of(resolved)](batch); }

void list_in_order(Target resolved, const std::uint32_t (&listed)[kMostListed], std::size_t count,
                   std::uint32_t instance, Span<CrowdPair> list) {
  order_kernels[index_of(resolved)](listed, count, instance, list.data, list.size);
}

}  // namespace spherechain
#endif
