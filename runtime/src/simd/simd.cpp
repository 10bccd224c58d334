// SPDX-License-Identifier: MIT
#include "simd/simd.h"

#include <algorithm>
#include <cstring>
#include <iterator>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/simd.cpp"
#include "simd/highway.h"

HWY_BEFORE_NAMESPACE();
namespace spherechain {
namespace HWY_NAMESPACE {

std::size_t count_lanes() { return hn::Lanes(hn::ScalableTag<float>()); }

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
  const Target* const end = std::end(kCompiled);
  const Target* const first = std::find_if(std::begin(kCompiled), end, machine_has);
  return {first, static_cast<std::size_t>(end - first)};
}

bool find_target(const char* name, Target& target) noexcept {
  for (std::size_t i = 0; i < kTargetCount; ++i) {
    const auto named = static_cast<Target>(i);
    Target resolved{};
    if (std::strcmp(name, sc_target_name(named)) == 0 && resolve_target(named, resolved)) {
      target = named;
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
  static constexpr const char* kNames[spherechain::kTargetCount] = {"best", "scalar", "sse2", "ssse3",
                                                                    "avx2", "avx512", "neon"};
  const auto number = static_cast<std::size_t>(target);
  return number < spherechain::kTargetCount ? kNames[number] : "unknown target";
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
