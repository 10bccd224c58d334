// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "spherechain/simd.h"

namespace spherechain::bench {

// Runs 12 independent chains of multiply-adds, `steps` long each, in vectors of the target's width: nothing but the
// machine's ports for them limits it. The result only keeps the compiler from leaving them out. `resolved` is not
// kBest.
inline constexpr std::size_t kProbeChains = 12;
float run_multiply_adds(Target resolved, std::size_t steps);

}  // namespace spherechain::bench
