// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>

namespace spherechain::test {

// a * b + c, rounded once. std::fma, but for MinGW's: that one rounds many arguments wrongly, so
// there the processor's instruction stands in, and the tests need a processor that has it.
#if defined(__MINGW32__) && defined(__x86_64__)
__attribute__((target("fma"))) inline float exact_fma(float a, float b, float c) { return __builtin_fmaf(a, b, c); }
#else
inline float exact_fma(float a, float b, float c) { return std::fma(a, b, c); }
#endif

}  // namespace spherechain::test
