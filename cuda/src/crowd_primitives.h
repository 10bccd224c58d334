// SPDX-License-Identifier: MIT
// Operations that the device has an instruction for and C++ spells differently. On the CPU the atomic ones are atomic
// too: the tests may run a block's threads at the same time.
#pragma once

#include <cfloat>
#include <cmath>
#include <cstring>

#include "crowd_view.h"

#if defined(__CUDA_ARCH__)
#define SPHERECHAIN_AMPERE (__CUDA_ARCH__ >= 800)
#else
#define SPHERECHAIN_AMPERE 0
#endif

namespace spherechain::cuda {

// a * b + c, rounded once.
SPHERECHAIN_HD float fused(float a, float b, float c) {
#if defined(__CUDA_ARCH__)
  return __fmaf_rn(a, b, c);
#else
  return std::fma(a, b, c);
#endif
}

// Returns the value before. Also for 64 bits.
template <typename T>
SPHERECHAIN_HD T add_to(T* to, T value) {
#if defined(__CUDA_ARCH__)
  if constexpr (sizeof(T) == 8) {
    return atomicAdd(reinterpret_cast<unsigned long long*>(to), static_cast<unsigned long long>(value));
  } else {
    return atomicAdd(to, value);
  }
#else
  return __atomic_fetch_add(to, value, __ATOMIC_RELAXED);
#endif
}

SPHERECHAIN_HD void set_bits(std::uint32_t* to, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  atomicOr(to, value);
#else
  __atomic_fetch_or(to, value, __ATOMIC_RELAXED);
#endif
}

// For several lanes that write the same value.
SPHERECHAIN_HD void set_alike(std::uint32_t& to, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
  to = value;
#else
  __atomic_store_n(&to, value, __ATOMIC_RELAXED);
#endif
}

// Of a word that is not 0.
SPHERECHAIN_HD std::uint32_t lowest_bit(std::uint32_t word) {
#if defined(__CUDA_ARCH__)
  return __ffs(static_cast<int>(word)) - 1;
#else
  return static_cast<std::uint32_t>(__builtin_ctz(word));
#endif
}

SPHERECHAIN_HD std::uint32_t count_bits(std::uint32_t word) {
#if defined(__CUDA_ARCH__)
  return static_cast<std::uint32_t>(__popc(word));
#else
  return static_cast<std::uint32_t>(__builtin_popcount(word));
#endif
}

// The bits of `word` moved up by one, with the sign of `value` below them.
SPHERECHAIN_HD std::uint32_t shift_in_sign(std::uint32_t word, float value) {
#if defined(__CUDA_ARCH__)
  return __funnelshift_l(__float_as_uint(value), word, 1);
#else
  return word << 1 | (value < 0 ? 1U : 0U);  // the sign bit of a NaN that the device computes is 0
#endif
}

// Rounds towards 0 to the eleven bits that the matrix units multiply; a NaN may become infinite.
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

// True if `is_so` is for any lane that runs with this one: on the device for any of the warp.
SPHERECHAIN_HD bool any_lane(bool is_so) {
#if defined(__CUDA_ARCH__)
  return __any_sync(0xFFFFFFFFU, is_so) != 0;
#else
  return is_so;
#endif
}

// Waits for the warp's other lanes: after a branch they would else go on one after another.
SPHERECHAIN_HD void rejoin() {
#if defined(__CUDA_ARCH__)
  __syncwarp();
#endif
}

// sqrtf(x) for kRootMin <= x <= kRootMax, without its test for other values. count_wrong_roots.cu tries every float.
inline constexpr float kRootMin = 0x1p-100F, kRootMax = 0x1p100F;
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

// Keeps the compiler from computing a figure again in each branch that reads it.
SPHERECHAIN_HD void make_once(float& figure) {
#if defined(__CUDA_ARCH__)
  asm volatile("" : "+f"(figure));
#else
  (void)figure;
#endif
}

// The number of a warp's next piece of work. On the device the next one that nobody has; on the CPU warps take turns.
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

// Copies 16 bytes, from Ampere on past the first cache, where the tables are. Before the barrier that makes the copies
// visible, call wait_for_copies().
SPHERECHAIN_HD void copy_past_cache(Float4* shared, const float* from) {
#if SPHERECHAIN_AMPERE
  const auto to = static_cast<std::uint32_t>(__cvta_generic_to_shared(shared));
  asm volatile("cp.async.cg.shared.global [%0], [%1], 16;" ::"r"(to), "l"(from) : "memory");
#else
  *shared = *reinterpret_cast<const Float4*>(from);
#endif
}

SPHERECHAIN_HD void wait_for_copies() {
#if SPHERECHAIN_AMPERE
  asm volatile("cp.async.wait_all;" ::: "memory");
#endif
}

}  // namespace spherechain::cuda
