// SPDX-License-Identifier: MIT
#include "runtime/src/simd/simd.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <iterator>
#if defined(_WIN32) && (defined(__x86_64__) || defined(_M_X64))
#include <intrin.h>
#endif

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/src/simd/simd.cpp"
#include "runtime/src/simd/highway.h"

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
#if HWY_TARGETS & HWY_WASM
    SC_TARGET_WASM,
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

#if defined(_WIN32) && HWY_ARCH_X86_64
// Microsoft's libraries have no table of the machine's features, which clang-cl's builtin would read, so cpuid is
// asked, once: it traps under a hypervisor. Threads that ask at the same time store the same number.
std::uint32_t ask_machine() {
  int a[4], b[4];  // eax, ebx, ecx, edx
  __cpuid(a, 0);
  const int last = a[0];
  __cpuid(a, 1);
  const auto has = [](int word, int first_bit, int second_bit) {
    return ((word >> first_bit) & 1) != 0 && ((word >> second_bit) & 1) != 0;
  };
  std::uint32_t found = 1U << index_of(SC_TARGET_SCALAR) | 1U << index_of(SC_TARGET_SSE2);  // of every x86-64
  if (has(a[2], 9, 9)) {
    found |= 1U << index_of(SC_TARGET_SSSE3);
  }
  if (last < 7 || !has(a[2], 27, 28)) {  // OSXSAVE, AVX
    return found;
  }
  __cpuidex(b, 7, 0);
#if defined(_MSC_VER) && !defined(__clang__)
  const auto saved = static_cast<std::uint32_t>(_xgetbv(0));
#else
  std::uint32_t saved = 0, high = 0;
  __asm__ volatile("xgetbv" : "=a"(saved), "=d"(high) : "c"(0));
#endif
  // FMA; AVX2; BMI and BMI2; registers of 256 bits are saved
  if (has(a[2], 12, 12) && has(b[1], 5, 5) && has(b[1], 3, 8) && (saved & 0x6U) == 0x6U) {
    found |= 1U << index_of(SC_TARGET_AVX2);
    // F and DQ; BW and CD; VL; registers of 512 bits and masks are saved
    if (has(b[1], 16, 17) && has(b[1], 30, 28) && has(b[1], 31, 31) && (saved & 0xE6U) == 0xE6U) {
      found |= 1U << index_of(SC_TARGET_AVX512);
    }
  }
  return found;
}

bool machine_has(Target target) {
  static std::atomic<std::uint32_t> known{0};
  std::uint32_t found = known.load(std::memory_order_relaxed);
  if (found == 0) {
    found = ask_machine();
    known.store(found, std::memory_order_relaxed);
  }
  return (found >> index_of(target) & 1U) != 0;
}
#else
// Whether the machine has a target, as libgcc or compiler-rt found out before main(): a look into a table, no
// instruction that traps under a hypervisor. They also ask whether the operating system saves the wide registers.
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
  // Other compilers: the instruction set that the build assumes.
  return target == SC_TARGET_SCALAR || count_lanes_kernels[index_of(target)] == &HWY_STATIC_DISPATCH(count_lanes);
#else
  return true;  // NEON and WebAssembly's are compiled only where the build may assume them
#endif
}
#endif

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
                                                                    "avx2", "avx512", "neon", "wasm"};
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
