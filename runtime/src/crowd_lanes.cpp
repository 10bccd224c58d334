// SPDX-License-Identifier: MIT
#include "crowd_lanes.h"

#include <cfloat>

#include "arithmetic.h"
#include "overlap.h"
#include "simd.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "crowd_lanes.cpp"
#include "highway.h"

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
      for (std::size_t lane = 0; lane < batch.count; ++lane) {
        row[lane] = batch.spheres[lane * batch.stride + i];
      }
      hn::LoadInterleaved4(kFloats, &row[0].x, x, y, z, radius);
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
    hn::Store(hn::Mul(hn::Set(kFloats, 0.5F), hn::Sub(squared_radius, squared_length)), kFloats, at + 7 * n);
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
    const std::size_t place = batch.pair_counts[lane]++ % kMostListed;
    batch.listed[lane][place].a = a;
    batch.listed[lane][place].b = b;
  }
}

// A pair and the lanes that may touch.
struct Candidate {
  std::uint32_t a, b;
  std::uint64_t lanes;
};

// All wanted pairs but near ones: as a tile's, first four multiply-adds with a margin for what they may be off.
HWY_INLINE void find_touching(LaneBatch& batch, Vector margin) {
  constexpr Floats kFloats;
  const std::size_t n = hn::Lanes(kFloats);
  const std::uint64_t in_use = (std::uint64_t{1} << batch.count) - 1;
  constexpr std::size_t kWordBits = 64;
  Candidate candidates[2 * kWordBits];
  std::size_t count = 0;
  std::size_t b = 0, row = 0, row_end = 0;  // the bits of b in the table
  Vector x = hn::Zero(kFloats), y = x, z = x, radius = x, least = x;
  for (std::size_t w = 0; w < batch.bit_words; ++w) {
    for (std::uint64_t wanted = batch.wanted[w]; wanted != 0; wanted &= wanted - 1) {
      const std::size_t bit = kWordBits * w + hwy::Num0BitsBelowLS1Bit_Nonzero64(wanted);
      if (bit >= row_end) {
        do {
          row = row_end;
          ++b;
          row_end += b;
        } while (bit >= row_end);
        const float* own = batch.lanes + kLaneFigures * n * b;
        radius = hn::Load(kFloats, own + 3 * n);
        x = hn::Load(kFloats, own + 4 * n);
        y = hn::Load(kFloats, own + 5 * n);
        z = hn::Load(kFloats, own + 6 * n);
        least = hn::Sub(hn::Neg(hn::Load(kFloats, own + 7 * n)), margin);
      }
      const float* other = batch.lanes + kLaneFigures * n * (bit - row);
      Vector sum = hn::MulAdd(radius, hn::Load(kFloats, other + 3 * n), hn::Load(kFloats, other + 7 * n));
      sum = hn::MulAdd(x, hn::Load(kFloats, other + 4 * n), sum);
      sum = hn::MulAdd(y, hn::Load(kFloats, other + 5 * n), sum);
      sum = hn::MulAdd(z, hn::Load(kFloats, other + 6 * n), sum);
      Candidate& candidate = candidates[count];
      candidate.a = static_cast<std::uint32_t>(bit - row);
      candidate.b = static_cast<std::uint32_t>(b);
      candidate.lanes = in_use & bits_of(hn::Gt(sum, least));
      count += candidate.lanes != 0 ? 1 : 0;
    }
    if (count >= kWordBits || w + 1 == batch.bit_words) {
      for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t a = candidates[i].a, other = candidates[i].b;
        report(batch, candidates[i].lanes & overlap<false, false>(load(batch.lanes, a), load(batch.lanes, other), 1.0F),
               a, other);
      }
      count = 0;
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
  if (!any_huge && hn::AllTrue(kFloats, hn::Le(extent, hn::Set(kFloats, kMostExtent)))) {
    find_touching(batch, hn::Add(hn::Mul(hn::Set(kFloats, kMarginOfExtent), extent), hn::Set(kFloats, kLeastMargin)));
    find_near<false>(batch);
  } else {
    find_touching_by_rule(batch);
    find_near<true>(batch);
  }
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
