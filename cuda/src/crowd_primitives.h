// SPDX-License-Identifier: MIT
// What the device has an instruction for, and a C++ compiler says otherwise.
#pragma once

#include <cfloat>
#include <cmath>
#include <cstring>

#include "crowd_view.h"

namespace spherechain::cuda {

SPHERECHAIN_HD float fused(float a, float b, float c) {
#if defined(__CUDA_ARCH__)
  return __fmaf_rn(a, b, c);
#else
  return std::fma(a, b, c);
#endif
}

SPHERECHAIN_HD void add_to(std::uint32_t* shared, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  atomicAdd(shared, value);
#else
  __atomic_fetch_add(shared, value, __ATOMIC_RELAXED);
#endif
}

// What it was before.
SPHERECHAIN_HD std::uint32_t take_place(std::uint32_t* shared) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(shared, 1U);
#else
  return __atomic_fetch_add(shared, 1U, __ATOMIC_RELAXED);
#endif
}

SPHERECHAIN_HD std::uint32_t take_places(std::uint32_t* shared, std::uint32_t count) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(shared, count);
#else
  return __atomic_fetch_add(shared, count, __ATOMIC_RELAXED);
#endif
}

SPHERECHAIN_HD void set_bits(std::uint32_t* shared, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  atomicOr(shared, value);
#else
  __atomic_fetch_or(shared, value, __ATOMIC_RELAXED);
#endif
}

// The same value by several lanes.
template <typename T>
SPHERECHAIN_HD void set_alike(T& to, T value) {
#if defined(__CUDA_ARCH__)
  to = value;
#else
  std::uint32_t words[sizeof value / sizeof(std::uint32_t)];
  std::memcpy(words, &value, sizeof value);
  auto* shared = reinterpret_cast<std::uint32_t*>(&to);
  for (const std::uint32_t word : words) {
    __atomic_store_n(shared++, word, __ATOMIC_RELAXED);
  }
#endif
}

SPHERECHAIN_HD std::uint64_t reserve(std::uint64_t* count, std::uint64_t value) {
#if defined(__CUDA_ARCH__)
  return atomicAdd(reinterpret_cast<unsigned long long*>(count), static_cast<unsigned long long>(value));
#else
  return __atomic_fetch_add(count, value, __ATOMIC_RELAXED);
#endif
}

SPHERECHAIN_HD std::uint32_t lowest_bit(std::uint32_t word) {
#if defined(__CUDA_ARCH__)
  return __ffs(static_cast<int>(word)) - 1;
#else
  return static_cast<std::uint32_t>(__builtin_ctz(word));
#endif
}

SPHERECHAIN_HD std::uint32_t lowest_bit(std::uint64_t word) {
#if defined(__CUDA_ARCH__)
  return __ffsll(static_cast<long long>(word)) - 1;
#else
  return static_cast<std::uint32_t>(__builtin_ctzll(word));
#endif
}

SPHERECHAIN_HD std::uint32_t leading_zeros(std::uint32_t word) {
#if defined(__CUDA_ARCH__)
  return static_cast<std::uint32_t>(__clz(static_cast<int>(word)));
#else
  return static_cast<std::uint32_t>(__builtin_clz(word));
#endif
}

// The bits of `word` moved up by one, the sign of `value` below them.
SPHERECHAIN_HD std::uint32_t shift_in_sign(std::uint32_t word, float value) {
#if defined(__CUDA_ARCH__)
  return __funnelshift_l(__float_as_uint(value), word, 1);
#else
  return word << 1 | (value < 0 ? 1U : 0U);  // a NaN the device computes has no sign
#endif
}

// The figure, nearer to 0, that the matrix units multiply; of what is no number, anything.
SPHERECHAIN_HD float eleven_bits(float x) {
  constexpr std::uint32_t kMask = ~0x1FFFU;
#if defined(__CUDA_ARCH__)
  return __uint_as_float(__float_as_uint(x) & kMask);
#else
  std::uint32_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  bits &= kMask;
  std::memcpy(&x, &bits, sizeof bits);
  return x;
#endif
}

// Whether it is so for any lane of the warp, or of those that run together: lanes stay together in loops that ask it.
SPHERECHAIN_HD bool any_lane(bool is_so) {
#if defined(__CUDA_ARCH__)
  return __any_sync(0xFFFFFFFFU, is_so) != 0;
#else
  return is_so;
#endif
}

SPHERECHAIN_HD void raise_to(std::uint32_t* shared, float value) {  // value >= 0
#if defined(__CUDA_ARCH__)
  atomicMax(shared, __float_as_uint(value));
#else
  std::uint32_t bits = 0, own = __atomic_load_n(shared, __ATOMIC_RELAXED);
  std::memcpy(&bits, &value, sizeof bits);
  while (own < bits && !__atomic_compare_exchange_n(shared, &own, bits, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
  }
#endif
}

SPHERECHAIN_HD std::uint32_t count_bits(std::uint32_t word) {
#if defined(__CUDA_ARCH__)
  return static_cast<std::uint32_t>(__popc(word));
#else
  return static_cast<std::uint32_t>(__builtin_popcount(word));
#endif
}

SPHERECHAIN_HD std::uint32_t count_bits(std::uint64_t word) {
#if defined(__CUDA_ARCH__)
  return static_cast<std::uint32_t>(__popcll(word));
#else
  return static_cast<std::uint32_t>(__builtin_popcountll(word));
#endif
}

// What sqrtf does where `x` is from kLeastRoot to kMostRoot, without its test for that.
inline constexpr float kLeastRoot = 0x1p-100F, kMostRoot = 0x1p100F;
SPHERECHAIN_HD float usual_root(float x) {
#if defined(__CUDA_ARCH__)
  float inverse;
  asm("rsqrt.approx.ftz.f32 %0, %1;" : "=f"(inverse) : "f"(x));
  const float root = x * inverse;
  return __fmaf_rn(__fmaf_rn(-root, root, x), 0.5F * inverse, root);
#else
  return sqrtf(x);
#endif
}

// Keeps the compiler from working a figure out anew in each branch that wants it.
SPHERECHAIN_HD void make_once(float& figure) {
#if defined(__CUDA_ARCH__)
  asm volatile("" : "+f"(figure));
#else
  (void)figure;
#endif
}

// What a warp is to do next: on the device each warp that asks gets the next place; the tests' warps, whose threads run
// one after another, take turns.
SPHERECHAIN_HD std::uint32_t deal(std::uint32_t* dealt, const Place& at, std::uint32_t round) {
#if defined(__CUDA_ARCH__)
  std::uint32_t place = 0;
  if (at.lane() == 0) {
    place = atomicInc(dealt, 0x7FFFFFFFU);  // atomicAdd would first count the lanes that add
  }
  return __shfl_sync(0xFFFFFFFFU, place, 0);
#else
  (void)dealt;
  return round * at.warps() + at.warp();
#endif
}

#if defined(__CUDA_ARCH__)
#define SPHERECHAIN_COPIES_PAST_CACHE (__CUDA_ARCH__ >= 800)
#else
#define SPHERECHAIN_COPIES_PAST_CACHE 0
#endif

// From Ampere on past the first cache, where the tables are. arrive() before the barrier that makes the copies seen.
SPHERECHAIN_HD void copy_past_cache(Float4* shared, const float* from) {
#if SPHERECHAIN_COPIES_PAST_CACHE
  const auto to = static_cast<std::uint32_t>(__cvta_generic_to_shared(shared));
  asm volatile("cp.async.cg.shared.global [%0], [%1], 16;" ::"r"(to), "l"(from) : "memory");
#else
  *shared = *reinterpret_cast<const Float4*>(from);
#endif
}

SPHERECHAIN_HD void arrive() {
#if SPHERECHAIN_COPIES_PAST_CACHE
  asm volatile("cp.async.wait_all;" ::: "memory");
#endif
}

// a / b rounded once, from share = 1 / b, for b from kLeastScale to 1 / kLeastScale and a root of usual_root, or a mean
// of such. The first quotient is off by less than two units in the last place, the second by less than one; what it
// leaves is exact, and so the third is a / b rounded (Markstein's theorem).
SPHERECHAIN_HD float usual_quotient(float a, float b, float share) {
  const float first = a * share, second = fused(fused(-b, first, a), share, first);
  return fused(fused(-b, second, a), share, second);
}

}  // namespace spherechain::cuda
