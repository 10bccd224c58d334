// SPDX-License-Identifier: MIT
#include "crowd_lanes.h"

#include <cfloat>

#include "arithmetic.h"
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
  const float* at = lanes + 4 * n * sphere;
  return {hn::Load(kFloats, at), hn::Load(kFloats, at + n), hn::Load(kFloats, at + 2 * n),
          hn::Load(kFloats, at + 3 * n)};
}

// From one instance after the other to one a lane, and padded. True where a radius is huge.
HWY_INLINE bool transpose(const LaneBatch& batch) {
  constexpr Floats kFloats;
  const std::size_t n = hn::Lanes(kFloats);
  bool any_huge = false;
  Sphere row[hn::MaxLanes(kFloats)] = {};
  for (std::size_t i = 0; i < batch.sphere_count; ++i) {
    float* at = batch.lanes + 4 * n * i;
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
    }
    if (batch.padding != nullptr) {
      radius = hn::Add(radius, hn::Set(kFloats, batch.padding[i]));
    }
    any_huge |= !hn::AllFalse(kFloats, hn::Gt(hn::Abs(radius), hn::Set(kFloats, kHugeRadius)));
    hn::Store(x, kFloats, at);
    hn::Store(y, kFloats, at + n);
    hn::Store(z, kFloats, at + 2 * n);
    hn::Store(radius, kFloats, at + 3 * n);
  }
  return any_huge;
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
HWY_INLINE void report(LaneBatch& batch, std::uint64_t lanes, std::size_t bit) {
  for (; lanes != 0; lanes &= lanes - 1) {
    const std::size_t lane = hwy::Num0BitsBelowLS1Bit_Nonzero64(lanes);
    batch.bits[lane * batch.bit_words + bit / 64] |= std::uint64_t{1} << (bit % 64);
    ++batch.pair_counts[lane];
  }
}

template <bool kCheckFinite>
HWY_INLINE void test_pairs(LaneBatch& batch) {
  const std::uint64_t in_use = (std::uint64_t{1} << batch.count) - 1;
  std::size_t b = 1;
  std::size_t row = 0;  // of the table: where b's bits begin
  LaneSphere q = load(batch.lanes, batch.sphere_count > 1 ? 1 : 0);
  for (std::size_t w = 0; w < batch.bit_words; ++w) {
    for (std::uint64_t wanted = batch.wanted[w]; wanted != 0; wanted &= wanted - 1) {
      const std::size_t bit = 64 * w + hwy::Num0BitsBelowLS1Bit_Nonzero64(wanted);
      if (bit >= row + b) {
        do {
          row += b;
          ++b;
        } while (bit >= row + b);
        q = load(batch.lanes, b);
      }
      const std::uint64_t lanes = in_use & overlap<kCheckFinite, false>(load(batch.lanes, bit - row), q, 1.0F);
      if (lanes != 0) {
        report(batch, lanes, bit);
      }
    }
  }
  for (std::size_t i = 0; i < batch.near.size; ++i) {
    const NearPair& near = batch.near[i];
    if (((batch.near_wanted[i / 64] >> (i % 64)) & 1U) != 0) {
      const std::uint64_t lanes =
          in_use & overlap<kCheckFinite, true>(load(batch.lanes, near.a), load(batch.lanes, near.b), near.reach);
      const std::size_t below = near.b;
      report(batch, lanes, below * (below - 1) / 2 + near.a);
    }
  }
}

void test_batch(LaneBatch& batch) {
  for (std::uint32_t& count : batch.pair_counts) {
    count = 0;
  }
  if (transpose(batch)) {
    test_pairs<true>(batch);
  } else {
    test_pairs<false>(batch);
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
