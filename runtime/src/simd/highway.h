// SPDX-License-Identifier: MIT
// Google Highway, header only: nothing of libhwy is linked, for its table of chosen targets is one a process, and
// Debian has it only as a shared library. A file of kernels starts with
//
//   #undef HWY_TARGET_INCLUDE
//   #define HWY_TARGET_INCLUDE "runtime/src/simd/highway.h"
//   #include "runtime/src/simd/highway.h"
//
// and is then compiled once a target, its kernels between HWY_BEFORE_NAMESPACE(); namespace spherechain { namespace
// HWY_NAMESPACE { and HWY_AFTER_NAMESPACE();. Code that comes once goes between #if HWY_ONCE and #endif. Kernels call
// no function of the standard library that is a template: one instantiated here would carry this target's instructions
// to machines without them.
//
// Headers of kernels are compiled once a target too: their guards go by HWY_TARGET_TOGGLE, as Highway's own do, and
// they include this header before the guard, so that each target meets the guard as the others do.

#if !defined(HWY_DISABLED_TARGETS)
// The targets of Highway's list, which grows, that are in spherechain::Target; by number where Highway 1.0.3 has no
// name: SSE2 and NEON without AES.
#define HWY_DISABLED_TARGETS \
  (~(HWY_SCALAR | (1LL << 14) | HWY_SSSE3 | HWY_AVX2 | HWY_AVX3 | HWY_NEON | (1LL << 29) | HWY_WASM))
// The scalar target is always there to compare with, and is the same one for every compiler.
#define HWY_COMPILE_ALL_ATTAINABLE
#define HWY_BROKEN_EMU128 1
#endif

// Highway's own assertions, on in builds without optimisation, call hwy::Abort of libhwy.
#if !defined(HWY_IS_DEBUG_BUILD)
#define HWY_IS_DEBUG_BUILD 0
#endif

#if defined(HWY_TARGET_INCLUDE)
#include <hwy/foreach_target.h>
#endif
#include <hwy/highway.h>

#include <cstdint>

#include "runtime/src/simd/fused.h"

// For SPHERECHAIN_KERNELS (simd.h). Highway 1.0.3 has no SSE2.
#if defined(HWY_CHOOSE_SSE2)
#define SPHERECHAIN_CHOOSE_SSE2(kernel) HWY_CHOOSE_SSE2(kernel)
#else
#define SPHERECHAIN_CHOOSE_SSE2(kernel) nullptr
#endif

// Newer Highways have a second NEON target, for cores without AES: we need none of it.
#if defined(HWY_NEON_WITHOUT_AES) && (HWY_TARGETS & HWY_NEON_WITHOUT_AES)
#define SPHERECHAIN_CHOOSE_NEON(kernel) HWY_CHOOSE_NEON_WITHOUT_AES(kernel)
#else
#define SPHERECHAIN_CHOOSE_NEON(kernel) HWY_CHOOSE_NEON(kernel)
#endif

#if defined(HWY_DISABLE_BMI2_FMA)
#error "spherechain's AVX2 target fuses multiply-adds: HWY_DISABLE_BMI2_FMA would change its results"
#endif

#if defined(SPHERECHAIN_SIMD_HIGHWAY_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_SIMD_HIGHWAY_H
#undef SPHERECHAIN_SIMD_HIGHWAY_H
#else
#define SPHERECHAIN_SIMD_HIGHWAY_H
#endif

#if HWY_TARGET == HWY_WASM
#include "runtime/src/simd/highway_wasm.h"
#endif

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

#if HWY_TARGET != HWY_WASM
namespace hn = hwy::HWY_NAMESPACE;
#endif

// Lane i as bit i.
HWY_INLINE std::uint64_t bits_of(hn::Mask<hn::ScalableTag<float>> mask) {
  constexpr hn::ScalableTag<float> kFloats;
#if HWY_TARGET == HWY_AVX3
  std::uint16_t bits = 0;
#else
  std::uint8_t bits = 0;
#endif
  static_assert(hn::MaxLanes(kFloats) <= 8 * sizeof bits, "a bit a lane");
  hn::StoreMaskBits(kFloats, mask, reinterpret_cast<std::uint8_t*>(&bits));
  return bits;
}

// The other way round; further bits are any.
HWY_INLINE hn::Mask<hn::ScalableTag<float>> mask_of(std::uint64_t bits) {
  return hn::LoadMaskBits(hn::ScalableTag<float>(), reinterpret_cast<const std::uint8_t*>(&bits));
}

#undef SPHERECHAIN_FUSES
#if HWY_TARGET == HWY_SCALAR || HWY_TARGET == HWY_SSSE3 || HWY_TARGET == (1LL << 14) || HWY_TARGET == HWY_WASM
#define SPHERECHAIN_FUSES 0
#else
#define SPHERECHAIN_FUSES 1
#endif

// a * b + c, rounded once on every target.
template <typename D, typename V>
HWY_INLINE V fused(D d, V a, V b, V c) {
#if SPHERECHAIN_FUSES
  (void)d;
  return hn::MulAdd(a, b, c);
#elif HWY_TARGET == HWY_SCALAR
  return hn::Set(d, fused_multiply_add(hn::GetLane(a), hn::GetLane(b), hn::GetLane(c)));
#else
  // As fused_multiply_add, two lanes at a time.
  static_assert(hn::MaxLanes(D()) == 4, "a whole register");
  const hn::Repartition<std::int32_t, D> words;
#if HWY_TARGET == HWY_WASM  // Highway 1.0.3 has no doubles there
  const auto sum_of = [](v128_t x, v128_t y, v128_t z) {
    return wasm_f64x2_add(wasm_f64x2_mul(wasm_f64x2_promote_low_f32x4(x), wasm_f64x2_promote_low_f32x4(y)),
                          wasm_f64x2_promote_low_f32x4(z));
  };
  const auto upper = [](V v) { return wasm_i64x2_shuffle(v.raw, v.raw, 1, 1); };
  const v128_t low_sums = sum_of(a.raw, b.raw, c.raw), high_sums = sum_of(upper(a), upper(b), upper(c));
  const hn::Vec<decltype(words)> low{low_sums}, high{high_sums};
#else
  const hn::Repartition<double, D> doubles;
  const hn::Half<D> half;
  const auto sum_of = [&](auto x, auto y, auto z) HWY_ATTR {
    return hn::Add(hn::Mul(hn::PromoteTo(doubles, x), hn::PromoteTo(doubles, y)), hn::PromoteTo(doubles, z));
  };
  const auto low_sums = sum_of(hn::LowerHalf(half, a), hn::LowerHalf(half, b), hn::LowerHalf(half, c));
  const auto high_sums = sum_of(hn::UpperHalf(half, a), hn::UpperHalf(half, b), hn::UpperHalf(half, c));
  const auto low = hn::BitCast(words, low_sums), high = hn::BitCast(words, high_sums);
#endif
  const auto low_words = hn::ConcatEven(words, high, low);
  const auto high_words = hn::And(hn::ConcatOdd(words, high, low), hn::Set(words, 0x7FFFFFFF));
  const auto is_half_way = hn::Eq(hn::And(low_words, hn::Set(words, 0x1FFFFFFF)), hn::Set(words, 0x10000000));
  const auto is_small = hn::And(hn::Gt(high_words, hn::Zero(words)), hn::Gt(hn::Set(words, 0x38100000), high_words));
  if (HWY_UNLIKELY(!hn::AllFalse(words, hn::Or(is_half_way, is_small)))) {
    HWY_ALIGN float lanes[3][4];
    hn::Store(a, d, lanes[0]);
    hn::Store(b, d, lanes[1]);
    hn::Store(c, d, lanes[2]);
    for (std::size_t i = 0; i < 4; ++i) {
      lanes[0][i] = fused_multiply_add_slow(lanes[0][i], lanes[1][i], lanes[2][i]);
    }
    return hn::Load(d, lanes[0]);
  }
#if HWY_TARGET == HWY_WASM
  return V{wasm_i64x2_shuffle(wasm_f32x4_demote_f64x2_zero(low_sums), wasm_f32x4_demote_f64x2_zero(high_sums), 0, 2)};
#else
  return hn::Combine(d, hn::DemoteTo(half, high_sums), hn::DemoteTo(half, low_sums));
#endif
#endif
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif
