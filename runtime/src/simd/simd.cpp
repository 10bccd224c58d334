// SPDX-License-Identifier: MIT
#include "simd/simd.h"

#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/simd.cpp"
#include "simd/highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

std::size_t count_lanes() {
  const hwy::HWY_NAMESPACE::ScalableTag<float> floats;
  return hwy::HWY_NAMESPACE::Lanes(floats);
}

}  // namespace HWY_NAMESPACE
}  // namespace spherechain
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace spherechain {
namespace {

SPHERECHAIN_KERNELS(count_lanes);

// Best first. Each machine that runs one runs those after it.
constexpr Target kCompiled[] = {
#if HWY_TARGETS & HWY_AVX3
    SC_TARGET_AVX512,
#endif
#if HWY_TARGETS & HWY_AVX2
    SC_TARGET_AVX2,
#endif
#if HWY_TARGETS & HWY_SSSE3
    SC_TARGET_SSSE3,
#endif
#if defined(HWY_SSE2) && (HWY_TARGETS & HWY_SSE2)
    SC_TARGET_SSE2,
#endif
#if HWY_ARCH_ARM && (HWY_TARGETS & ~HWY_SCALAR)
    SC_TARGET_NEON,
#endif
    SC_TARGET_SCALAR};
constexpr std::size_t kCompiledCount = sizeof kCompiled / sizeof kCompiled[0];

constexpr bool all_have_kernels() {
  for (const Target target : kCompiled) {
    if (count_lanes_kernels[index_of(target)] == nullptr) {
      return false;
    }
  }
  return true;
}
static_assert(all_have_kernels());

// What the machine has, as libgcc or compiler-rt found it out before main(): a look into a table, no instruction that
// traps under a hypervisor. They also ask whether the operating system saves the wide registers.
bool machine_has([[maybe_unused]] Target target) {
#if HWY_ARCH_X86 && (defined(__GNUC__) || defined(__clang__))
  switch (target) {
    case SC_TARGET_AVX512:
      return machine_has(SC_TARGET_AVX2) && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
             __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
             __builtin_cpu_supports("avx512cd");
    case SC_TARGET_AVX2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
             __builtin_cpu_supports("bmi2");
    case SC_TARGET_SSSE3:
      return __builtin_cpu_supports("ssse3");
    default:
      return true;
  }
#elif HWY_ARCH_X86
  // Other compilers: what the build was told to assume.
  return target == SC_TARGET_SCALAR || count_lanes_kernels[index_of(target)] == &HWY_STATIC_DISPATCH(count_lanes);
#else
  return true;  // NEON is compiled only where the build may assume it
#endif
}

}  // namespace

Span<const Target> supported_targets() noexcept {
  std::size_t first = 0;
  while (!machine_has(kCompiled[first])) {
    ++first;
  }
  return {kCompiled + first, kCompiledCount - first};
}

bool find_target(const char* name, Target& target) noexcept {
  if (std::strcmp(name, sc_target_name(SC_TARGET_BEST)) == 0) {
    target = SC_TARGET_BEST;
    return true;
  }
  for (const Target supported : supported_targets()) {
    if (std::strcmp(name, sc_target_name(supported)) == 0) {
      target = supported;
      return true;
    }
  }
  return false;
}

bool resolve_target(Target wanted, Target& resolved) noexcept {
  for (const Target supported : supported_targets()) {
    if (wanted == SC_TARGET_BEST || wanted == supported) {
      resolved = supported;
      return true;
    }
  }
  return false;
}

std::size_t lanes_of(Target target) noexcept {
  Target resolved{};
  return resolve_target(target, resolved) ? count_lanes_kernels[index_of(resolved)]() : 0;
}

}  // namespace spherechain

extern "C" {

const char* sc_target_name(sc_target target) noexcept {
  switch (target) {
    case SC_TARGET_BEST:
      return "best";
    case SC_TARGET_SCALAR:
      return "scalar";
    case SC_TARGET_SSE2:
      return "sse2";
    case SC_TARGET_SSSE3:
      return "ssse3";
    case SC_TARGET_AVX2:
      return "avx2";
    case SC_TARGET_AVX512:
      return "avx512";
    case SC_TARGET_NEON:
      return "neon";
  }
  return "unknown target";
}

const sc_target* sc_supported_targets(size_t* count) noexcept {
  const spherechain::Span<const sc_target> targets = spherechain::supported_targets();
  if (count != nullptr) {
    *count = targets.size;
  }
  return targets.data;
}

}  // extern "C"
#endif
