// SPDX-License-Identifier: MIT
// Spheres into registers, and the rule of detect.h for listed pairs, a register of them at a time.
#include "runtime/src/simd/highway.h"

#if defined(SPHERECHAIN_PAIRS_SPHERE_REGISTERS_H) == defined(HWY_TARGET_TOGGLE)  // once a target
#ifdef SPHERECHAIN_PAIRS_SPHERE_REGISTERS_H
#undef SPHERECHAIN_PAIRS_SPHERE_REGISTERS_H
#else
#define SPHERECHAIN_PAIRS_SPHERE_REGISTERS_H
#endif

#include <cfloat>

#include "spherechain/types.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

constexpr std::size_t kListLanes = hwy::HWY_NAMESPACE::MaxLanes(hwy::HWY_NAMESPACE::ScalableTag<float>());

#if HWY_TARGET != HWY_SCALAR

// Block b of 128 bits is the sphere `sphere_at(4 * b)`.
template <typename D, typename SphereAt>
HWY_INLINE hwy::HWY_NAMESPACE::Vec<D> load_blocks(D d, const SphereAt& sphere_at) {
#if HWY_TARGET == HWY_AVX3  // four loads; halves put together would be shuffled
  __m512 spheres = _mm512_castps128_ps512(_mm_loadu_ps(&sphere_at(0).x));
  spheres = _mm512_insertf32x4(spheres, _mm_loadu_ps(&sphere_at(4).x), 1);
  spheres = _mm512_insertf32x4(spheres, _mm_loadu_ps(&sphere_at(8).x), 2);
  spheres = _mm512_insertf32x4(spheres, _mm_loadu_ps(&sphere_at(12).x), 3);
  (void)d;
  return hn::Vec<D>{spheres};
#elif HWY_TARGET == HWY_AVX2
  const hn::Half<D> half;
  return hn::Combine(d, hn::LoadU(half, &sphere_at(4).x), hn::LoadU(half, &sphere_at(0).x));
#else
  return hn::LoadU(d, &sphere_at(0).x);
#endif
}

// From vectors whose block b is sphere 4 b + i, for i of 0 to 3, to one a figure, sphere by sphere: in each block four
// by four figures are turned about.
template <typename D, typename V>
HWY_INLINE void turn(D d, V v0, V v1, V v2, V v3, V& x, V& y, V& z, V& radius) {
  const V low02 = hn::InterleaveLower(d, v0, v2), low13 = hn::InterleaveLower(d, v1, v3),
          high02 = hn::InterleaveUpper(d, v0, v2), high13 = hn::InterleaveUpper(d, v1, v3);
  x = hn::InterleaveLower(d, low02, low13);
  y = hn::InterleaveUpper(d, low02, low13);
  z = hn::InterleaveLower(d, high02, high13);
  radius = hn::InterleaveUpper(d, high02, high13);
}

#endif

// A register's worth of spheres, the ith of them `sphere_at(i)`.
template <typename D, typename SphereAt, typename V>
HWY_INLINE void load_spheres(D d, const SphereAt& sphere_at, V& x, V& y, V& z, V& radius) {
#if HWY_TARGET == HWY_SCALAR
  hwy::HWY_NAMESPACE::LoadInterleaved4(d, &sphere_at(0).x, x, y, z, radius);
#else
  const auto blocks = [&](std::size_t i) HWY_ATTR {
    return load_blocks(d, [&](std::size_t k) -> const Sphere& { return sphere_at(k + i); });
  };
  turn(d, blocks(0), blocks(1), blocks(2), blocks(3), x, y, z, radius);
#endif
}

// A register's worth of spheres that follow each other.
template <typename D, typename V>
HWY_INLINE void load_next_spheres(D d, const Sphere* spheres, V& x, V& y, V& z, V& radius) {
#if HWY_TARGET == HWY_AVX3  // eight spheres' figures together first: whole registers, and half the shuffles
  HWY_ALIGN static constexpr std::int32_t kXy[16] = {0, 4, 8, 12, 16, 20, 24, 28, 1, 5, 9, 13, 17, 21, 25, 29};
  HWY_ALIGN static constexpr std::int32_t kZr[16] = {2, 6, 10, 14, 18, 22, 26, 30, 3, 7, 11, 15, 19, 23, 27, 31};
  const __m512i first = _mm512_load_si512(kXy), second = _mm512_load_si512(kZr);
  const float* const figures = &spheres->x;
  const __m512 v0 = _mm512_loadu_ps(figures), v1 = _mm512_loadu_ps(figures + 16), v2 = _mm512_loadu_ps(figures + 32),
               v3 = _mm512_loadu_ps(figures + 48);
  const V low_xy{_mm512_permutex2var_ps(v0, first, v1)}, low_zr{_mm512_permutex2var_ps(v0, second, v1)};
  const V high_xy{_mm512_permutex2var_ps(v2, first, v3)}, high_zr{_mm512_permutex2var_ps(v2, second, v3)};
  x = hn::ConcatLowerLower(d, high_xy, low_xy);
  y = hn::ConcatUpperUpper(d, high_xy, low_xy);
  z = hn::ConcatLowerLower(d, high_zr, low_zr);
  radius = hn::ConcatUpperUpper(d, high_zr, low_zr);
#else
  load_spheres(
      d, [&](std::size_t k) -> const Sphere& { return spheres[k]; }, x, y, z, radius);
#endif
}

// The rule for kListLanes pairs, spheres p and q of each. With a rest_scale of 1 the rule for rest pairs is that for
// all others, and one below 1 only ever narrows that, also after rounding.
template <typename P, typename Q, typename V>
HWY_INLINE hwy::HWY_NAMESPACE::Mask<hwy::HWY_NAMESPACE::ScalableTag<float>> touching(const P& p_at, const Q& q_at,
                                                                                     V rest_scales) {
  const hn::ScalableTag<float> d;
#if HWY_TARGET == HWY_SCALAR
  const Sphere &p = p_at(0), &q = q_at(0);
  const V dx = hn::Set(d, p.x - q.x), dy = hn::Set(d, p.y - q.y), dz = hn::Set(d, p.z - q.z);
  const V s = hn::Set(d, p.radius + q.radius);
#else
  // p - (x, y, z, -radius) is three differences and a sum, rounded as the rule's are.
  HWY_ALIGN static constexpr float kSign[16] = {0, 0, 0, -0.0F, 0, 0, 0, -0.0F, 0, 0, 0, -0.0F, 0, 0, 0, -0.0F};
  const V sign = hn::Load(d, kSign);
  const auto differences = [&](std::size_t i) HWY_ATTR {
    const V p = load_blocks(d, [&](std::size_t k) -> const Sphere& { return p_at(k + i); });
    const V q = load_blocks(d, [&](std::size_t k) -> const Sphere& { return q_at(k + i); });
    return hn::Sub(p, hn::Xor(q, sign));
  };
  V dx, dy, dz, s;
  turn(d, differences(0), differences(1), differences(2), differences(3), dx, dy, dz, s);
#endif
  const V d2 = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
  const V s2 = hn::Mul(s, s), t = hn::Mul(rest_scales, s);
  return hn::And(hn::Lt(d2, hn::Mul(t, t)), hn::Le(s2, hn::Set(d, FLT_MAX)));
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#endif
