// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "spherechain/types.h"

namespace spherechain::bench {

// Runs 12 independent chains of multiply-adds, `steps` long each, in vectors of the target's width. Only the machine's
// multiply-add ports limit it. The result keeps the compiler from leaving the work out. `resolved` is not
// SC_TARGET_BEST.
inline constexpr std::size_t kProbeChains = 12;
float run_multiply_adds(Target resolved, std::size_t steps);

}  // namespace spherechain::bench
