// SPDX-License-Identifier: MIT
// Google Highway, header only: nothing of libhwy is linked, for its table of chosen targets is one a process, and
// Debian has it only as a shared library. A file of kernels starts with
//
//   #undef HWY_TARGET_INCLUDE
//   #define HWY_TARGET_INCLUDE "its_own_name.cpp"
//   #include "highway.h"
//
// and is then compiled once a target, its kernels between HWY_BEFORE_NAMESPACE(); namespace spherechain { namespace
// HWY_NAMESPACE { and HWY_AFTER_NAMESPACE();. What comes once goes between #if HWY_ONCE and #endif. Kernels call no
// function of the standard library that is a template: one instantiated here would carry this target's instructions to
// machines without them.
//
// No include guard: Highway wants to be included again for every target.

#if !defined(HWY_DISABLED_TARGETS)
// Of Highway's list, which grows, only the targets of spherechain::Target; by number where Highway 1.0.3 has no name:
// SSE2 and NEON without AES.
#define HWY_DISABLED_TARGETS (~(HWY_SCALAR | (1LL << 14) | HWY_SSSE3 | HWY_AVX2 | HWY_AVX3 | HWY_NEON | (1LL << 29)))
// The scalar target is always there to compare with, and is the same one for every compiler.
#define HWY_COMPILE_ALL_ATTAINABLE
#define HWY_BROKEN_EMU128 1
#endif

#if defined(HWY_TARGET_INCLUDE)
#include <hwy/foreach_target.h>
#endif
#include <hwy/highway.h>

#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

// Lane i as bit i.
HWY_INLINE std::uint64_t bits_of(hwy::HWY_NAMESPACE::Mask<hwy::HWY_NAMESPACE::ScalableTag<float>> mask) {
  constexpr hwy::HWY_NAMESPACE::ScalableTag<float> kFloats;
#if HWY_TARGET == HWY_AVX3
  std::uint16_t bits = 0;
#else
  std::uint8_t bits = 0;
#endif
  static_assert(hwy::HWY_NAMESPACE::MaxLanes(kFloats) <= 8 * sizeof bits, "a bit a lane");
  hwy::HWY_NAMESPACE::StoreMaskBits(kFloats, mask, reinterpret_cast<std::uint8_t*>(&bits));
  return bits;
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();
