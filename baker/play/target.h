// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "spherechain/types.h"

namespace spherechain::baker {

// The instruction set to run on: never kBest. `backend` is "auto", "simd" or "scalar"; the first two take what the
// environment variable SPHERECHAIN_TARGET names, and else, or where that is empty, the machine's best. Throws
// Error(kUsage) where it names a target that this machine does not have.
Target choose_target(const std::string& backend);

const char* backend_name(Target target);  // "scalar" or "simd"
std::string backend_text(Target target);  // "scalar" or "simd (avx2)"
std::string supported_targets_text();     // "avx2, ssse3, scalar"

}  // namespace spherechain::baker
