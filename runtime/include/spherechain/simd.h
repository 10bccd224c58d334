// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/abi.h"
#include "spherechain/status.h"
#include "spherechain/types.h"

namespace spherechain {

// The instruction sets that inner loops are compiled for. A job takes the best one the machine has, unless its `target`
// names another: all give the same results, bit for bit, so naming one is for tests, and for games that want no
// AVX-512. Nothing is remembered between calls and no environment variable is read here; spherechain's tools read
// SPHERECHAIN_TARGET and hand its value to find_target(). Values are never reassigned.
enum class Target : std::uint8_t {
  kBest = 0,
  kScalar = 1,  // every build has it, every machine runs it
  kSse2 = 2,    // not with the Highway of Debian 12
  kSsse3 = 3,
  kAvx2 = 4,    // with BMI2 and FMA
  kAvx512 = 5,  // F, VL, DQ, BW, CD
  kNeon = 6,
};

// "scalar", "sse2", "ssse3", "avx2", "avx512", "neon"; "best"; never null, also for values that do not exist.
SPHERECHAIN_API const char* to_string(Target target) noexcept;

// The targets this build has and this machine runs, best first; the last is kScalar. Never empty, never kBest.
SPHERECHAIN_API Span<const Target> supported_targets() noexcept;

// What kBest stands for here.
inline Target best_target() noexcept { return supported_targets()[0]; }

// The target of that name. kOk; kNullArgument; kUnsupportedTarget where nothing supported has that name ("best" is one
// that does); `target` is written only with kOk.
SPHERECHAIN_API Status find_target(const char* name, Target& target) noexcept;

// Floats a vector register of that target holds: 1, 4, 8 or 16; 0 where it is not supported.
SPHERECHAIN_API std::size_t lanes_of(Target target) noexcept;

}  // namespace spherechain
