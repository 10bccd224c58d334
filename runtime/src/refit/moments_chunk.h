// SPDX-License-Identifier: MIT
// Step 3 of refit by moments, its end: adds the lanes of four spheres at a time, and makes centres and radii.
#include "runtime/src/simd/highway.h"

#if defined(SPHERECHAIN_REFIT_MOMENTS_CHUNK_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_REFIT_MOMENTS_CHUNK_H
#undef SPHERECHAIN_REFIT_MOMENTS_CHUNK_H
#else
#define SPHERECHAIN_REFIT_MOMENTS_CHUNK_H
#endif

#include "runtime/src/refit/moments_bones.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {
namespace moments {

constexpr std::size_t kChunk = 4;  // spheres finished together
constexpr std::size_t kSums = 32;  // spheres whose sums are kept: finished at once, none waits for its own sums

// Lane sums of kSums spheres: of the centre three rows of four columns, of the squared spread 16 lanes; and `wanted`,
// the radius at rest over the spread at rest.
struct Sums {
  HWY_ALIGN float centers[kSums][kMomentSize];
  HWY_ALIGN float squares[kSums][kMomentSize];
  HWY_ALIGN float wanted[kSums];
};

// The square root; 0 for squares that rounding made negative. Adding square * 0 makes the spread NaN where the square
// is not finite.
HWY_INLINE hn::Vec<Lanes4> spread_of(hn::Vec<Lanes4> square) {
  const auto zero = hn::Zero(Lanes4());
  return hn::MulAdd(square, zero, hn::Sqrt(hn::IfThenZeroElse(hn::Le(square, zero), square)));
}

// The first two steps of the tree that adds 16 lanes in a fixed order: 16 to 8, then 8 to 4.
HWY_INLINE void fold(const float* sums, float* out) {
  const Lanes4 d;
  for (std::size_t i = 0; i < 4; i += hn::MaxLanes(d)) {
    const auto sum = [&](std::size_t k) HWY_ATTR { return hn::Add(hn::Load(d, sums + k), hn::Load(d, sums + k + 8)); };
    hn::Store(hn::Add(sum(i), sum(i + 4)), d, out + i);
  }
}

// out[i] = (v[i][0] + v[i][2]) + (v[i][1] + v[i][3]), the v[i] `step` floats apart.
HWY_INLINE void sum_four(const float* v, std::size_t step, float* out) {
#if HWY_TARGET == HWY_SCALAR
  for (std::size_t i = 0; i < kChunk; ++i, v += step) {
    out[i] = (v[0] + v[2]) + (v[1] + v[3]);
  }
#else
  const Lanes4 d;
  const auto half = [&](std::size_t i) HWY_ATTR {
    const auto a = hn::Load(d, v + i * step), b = hn::Load(d, v + (i + 1) * step);
    return hn::Add(hn::ConcatLowerLower(d, b, a), hn::ConcatUpperUpper(d, b, a));
  };
  const auto low = half(0), high = half(2);
  hn::Store(hn::Add(hn::ConcatEven(d, high, low), hn::ConcatOdd(d, high, low)), d, out);
#endif
}

// Finishes `count` spheres of the sums from `first` on, kChunk at most: writes them to spheres[numbers[i]].
HWY_INLINE void finish(const Sums& sums, std::size_t first, std::size_t count, const std::uint32_t* numbers,
                       const Vector (&references)[kParts], Sphere* spheres) {
  const Lanes4 d;
  HWY_ALIGN float shift[kMomentSize];
  for (std::size_t part = 0; part < kParts; ++part) {
    hn::Store(references[part], Lanes16(), shift + part * kLanes);
  }
  HWY_ALIGN float figures[4][kChunk], fours[kChunk][4];
  for (std::size_t i = 0; i < kChunk; ++i) {
    fold(sums.squares[first + i], fours[i]);
  }
  for (std::size_t row = 0; row < 3; ++row) {
    sum_four(sums.centers[first] + 4 * row, kMomentSize, figures[row]);
  }
  sum_four(fours[0], 4, figures[3]);
  HWY_ALIGN Sphere out[kChunk];
  for (std::size_t i = 0; i < kChunk; i += hn::MaxLanes(d)) {
    hn::StoreInterleaved4(hn::Add(hn::Load(d, figures[0] + i), hn::Set(d, shift[3])),
                          hn::Add(hn::Load(d, figures[1] + i), hn::Set(d, shift[7])),
                          hn::Add(hn::Load(d, figures[2] + i), hn::Set(d, shift[11])),
                          hn::Mul(hn::Load(d, sums.wanted + first + i), spread_of(hn::Load(d, figures[3] + i))), d,
                          &out[i].x);
  }
  for (std::size_t i = 0; i < count; ++i) {
    spheres[numbers[i]] = out[i];
  }
}

}  // namespace moments
}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif
