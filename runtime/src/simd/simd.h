// SPDX-License-Identifier: MIT
// Which compiled form of a kernel a job calls.
#pragma once

#include <cstddef>

#include "runtime/src/base/span.h"
#include "spherechain/types.h"

namespace spherechain {

inline constexpr std::size_t kTargetCount = 8;  // values of Target

// The targets this build has and this machine runs, best first; the last is SC_TARGET_SCALAR.
Span<const Target> supported_targets() noexcept;

// The target of that name: "best", or a supported one's. Else false.
bool find_target(const char* name, Target& target) noexcept;

// Floats a vector register of that target holds: 1, 4, 8 or 16; 0 where it is not supported.
std::size_t lanes_of(Target target) noexcept;

// Resolves a job's `target` on this machine. If it is not available, returns false and leaves `resolved` unwritten.
bool resolve_target(Target wanted, Target& resolved) noexcept;

// The forms of `kernel`, by the number of the target, for those this build has: of constant size, since which are
// compiled is known where the kernel is. Stands in namespace spherechain, under #if HWY_ONCE. Call the one wanted with
// kernel##_kernels[index_of(resolved)](arguments).
#define SPHERECHAIN_KERNELS(kernel)                                                                                   \
  constexpr decltype(&HWY_STATIC_DISPATCH(kernel)) kernel##_kernels[kTargetCount] = {nullptr,                         \
                                                                                     HWY_CHOOSE_FALLBACK(kernel),     \
                                                                                     SPHERECHAIN_CHOOSE_SSE2(kernel), \
                                                                                     HWY_CHOOSE_SSSE3(kernel),        \
                                                                                     HWY_CHOOSE_AVX2(kernel),         \
                                                                                     HWY_CHOOSE_AVX3(kernel),         \
                                                                                     SPHERECHAIN_CHOOSE_NEON(kernel), \
                                                                                     HWY_CHOOSE_WASM(kernel)}

constexpr std::size_t index_of(Target resolved) { return static_cast<std::size_t>(resolved); }

}  // namespace spherechain
