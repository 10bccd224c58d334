// SPDX-License-Identifier: MIT
// What crowds can besides refit and detect, in tables of their own. False where the CPU's jobs say otherwise.
#pragma once

#include <cstdint>
#include <string>

#include "contestants.h"

namespace spherechain::bench {

// Bones in, balls around the skin and the pairs that could touch out.
bool bench_covers(const std::string& folder, const std::string& name, const Ceilings& ceilings);

// A character whose spheres are each split into that many: too large for shared memory.
bool bench_large(const std::string& folder, const std::string& name, std::uint32_t parts, const Ceilings& ceilings);

}  // namespace spherechain::bench
