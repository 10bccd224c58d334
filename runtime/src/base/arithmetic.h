// SPDX-License-Identifier: MIT
// The build options under which the headers' fixed arithmetic holds. The same pairs everywhere need the same roundings
// everywhere, so a build that breaks this stops here.
#pragma once

#include <cfloat>

#if defined(__FAST_MATH__)
#error "spherechain's runtime cannot be built with -ffast-math: results would differ between machines"
#endif

#if !defined(_MSC_VER)
static_assert(FLT_EVAL_METHOD == 0, "float expressions must be rounded to float (on x86: SSE, not x87)");
#endif
