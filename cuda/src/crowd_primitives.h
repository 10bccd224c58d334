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

// sqrtf(x) for kRootMin <= x <= kRootMax is usual_root(x). count_wrong_roots.cu tries every float.
inline constexpr float kRootMin = 0x1p-100F, kRootMax = 0x1p100F;

#if defined(__CUDA_ARCH__)

// a * b + c, rounded once.
SPHERECHAIN_HD float fused(float a, float b, float c) { return __fmaf_rn(a, b, c); }

// Without sqrtf()'s test for other values.
SPHERECHAIN_HD float usual_root(float x) {
  float inverse;
  asm("rsqrt.approx.ftz.f32 %0, %1;" : "=f"(inverse) : "f"(x));
  const float root = x * inverse;
  return __fmaf_rn(__fmaf_rn(-root, root, x), 0.5F * inverse, root);
}

// Returns the value before.
SPHERECHAIN_HD std::uint32_t add_to(std::uint32_t* to, std::uint32_t value) { return atomicAdd(to, value); }
SPHERECHAIN_HD std::uint64_t add_to(std::uint64_t* to, std::uint64_t value) {
  return atomicAdd(reinterpret_cast<unsigned long long*>(to), static_cast<unsigned long long>(value));
}

SPHERECHAIN_HD void set_bits(std::uint32_t* to, std::uint32_t value) { atomicOr(to, value); }

// For several lanes that write the same value.
SPHERECHAIN_HD void set_alike(std::uint32_t& to, std::uint32_t value) { to = value; }

// Index of the lowest set bit. The word must not be 0.
SPHERECHAIN_HD std::uint32_t lowest_bit(std::uint32_t word) { return __ffs(static_cast<int>(word)) - 1; }

SPHERECHAIN_HD std::uint32_t count_bits(std::uint32_t word) { return static_cast<std::uint32_t>(__popc(word)); }

// The bits of `word` moved up by one, with the sign of `value` below them.
SPHERECHAIN_HD std::uint32_t shift_in_sign(std::uint32_t word, float value) {
  return __funnelshift_l(__float_as_uint(value), word, 1);
}

// True if `is_so` is for any lane that runs with this one: on the device for any of the warp.
SPHERECHAIN_HD bool any_lane(bool is_so) { return __any_sync(0xFFFFFFFFU, is_so) != 0; }

// Waits for the warp's other lanes: after a branch they would else go on one after another.
SPHERECHAIN_HD void rejoin() { __syncwarp(); }

// Keeps the compiler from computing a figure again in each branch that reads it.
SPHERECHAIN_HD void make_once(float& figure) { asm volatile("" : "+f"(figure)); }

// The number of a warp's next piece of work. On the device the next one that nobody has; on the CPU warps take turns.
SPHERECHAIN_HD std::uint32_t deal(std::uint32_t* dealt, const Place& at, std::uint32_t) {
  std::uint32_t place = 0;
  if (at.lane() == 0) {
    place = atomicInc(dealt, 0x7FFFFFFFU);  // atomicAdd would first count the lanes that add
  }
  return __shfl_sync(0xFFFFFFFFU, place, 0);
}

#else

SPHERECHAIN_HD float fused(float a, float b, float c) { return std::fma(a, b, c); }
SPHERECHAIN_HD float usual_root(float x) { return sqrtf(x); }
template <typename T>
SPHERECHAIN_HD T add_to(T* to, T value) {
  return __atomic_fetch_add(to, value, __ATOMIC_RELAXED);
}
SPHERECHAIN_HD void set_bits(std::uint32_t* to, std::uint32_t value) { __atomic_fetch_or(to, value, __ATOMIC_RELAXED); }
SPHERECHAIN_HD void set_alike(std::uint32_t& to, std::uint32_t value) {
  __atomic_store_n(&to, value, __ATOMIC_RELAXED);
}
SPHERECHAIN_HD std::uint32_t lowest_bit(std::uint32_t word) { return static_cast<std::uint32_t>(__builtin_ctz(word)); }
SPHERECHAIN_HD std::uint32_t count_bits(std::uint32_t word) {
  return static_cast<std::uint32_t>(__builtin_popcount(word));
}
SPHERECHAIN_HD std::uint32_t shift_in_sign(std::uint32_t word, float value) {
  return word << 1 | (value < 0 ? 1U : 0U);  // the sign bit of a NaN that the device computes is 0
}
SPHERECHAIN_HD bool any_lane(bool is_so) { return is_so; }
SPHERECHAIN_HD void rejoin() {}
SPHERECHAIN_HD void make_once(float&) {}
SPHERECHAIN_HD std::uint32_t deal(std::uint32_t*, const Place& at, std::uint32_t round) {
  return round * at.warps() + at.warp();
}

#endif

// Rounds towards 0 to the eleven bits that the matrix units multiply; a NaN may become infinite.
SPHERECHAIN_HD float eleven_bits(float x) {
  std::uint32_t bits = 0;
  std::memcpy(&bits, &x, sizeof bits);
  bits &= ~0x1FFFU;
  std::memcpy(&x, &bits, sizeof bits);
  return x;
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
