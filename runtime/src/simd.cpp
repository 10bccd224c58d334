// SPDX-License-Identifier: MIT
#include "simd.h"

#include <cstring>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd.cpp"
#include "highway.h"

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
    Target::kAvx512,
#endif
#if HWY_TARGETS & HWY_AVX2
    Target::kAvx2,
#endif
#if HWY_TARGETS & HWY_SSSE3
    Target::kSsse3,
#endif
#if defined(HWY_SSE2) && (HWY_TARGETS & HWY_SSE2)
    Target::kSse2,
#endif
#if HWY_ARCH_ARM && (HWY_TARGETS & ~HWY_SCALAR)
    Target::kNeon,
#endif
    Target::kScalar};
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
    case Target::kAvx512:
      return machine_has(Target::kAvx2) && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
             __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
             __builtin_cpu_supports("avx512cd");
    case Target::kAvx2:
      return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
             __builtin_cpu_supports("bmi2");
    case Target::kSsse3:
      return __builtin_cpu_supports("ssse3");
    default:
      return true;
  }
#elif HWY_ARCH_X86
  // Other compilers: what the build was told to assume.
  return target == Target::kScalar || count_lanes_kernels[index_of(target)] == &HWY_STATIC_DISPATCH(count_lanes);
#else
  return true;  // NEON is compiled only where the build may assume it
#endif
}

}  // namespace

const char* to_string(Target target) noexcept {
  switch (target) {
    case Target::kBest:
      return "best";
    case Target::kScalar:
      return "scalar";
    case Target::kSse2:
      return "sse2";
    case Target::kSsse3:
      return "ssse3";
    case Target::kAvx2:
      return "avx2";
    case Target::kAvx512:
      return "avx512";
    case Target::kNeon:
      return "neon";
  }
  return "unknown target";
}

Span<const Target> supported_targets() noexcept {
  std::size_t first = 0;
  while (!machine_has(kCompiled[first])) {
    ++first;
  }
  return {kCompiled + first, kCompiledCount - first};
}

Status find_target(const char* name, Target& target) noexcept {
  if (name == nullptr) {
    return Status::kNullArgument;
  }
  if (std::strcmp(name, to_string(Target::kBest)) == 0) {
    target = Target::kBest;
    return Status::kOk;
  }
  for (const Target supported : supported_targets()) {
    if (std::strcmp(name, to_string(supported)) == 0) {
      target = supported;
      return Status::kOk;
    }
  }
  return Status::kUnsupportedTarget;
}

bool resolve_target(Target wanted, Target& resolved) noexcept {
  for (const Target supported : supported_targets()) {
    if (wanted == Target::kBest || wanted == supported) {
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
#endif
