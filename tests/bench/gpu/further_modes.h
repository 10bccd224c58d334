// SPDX-License-Identifier: MIT
// Large assets, in a table of their own.
#pragma once

#include <cstdint>
#include <string>

#include "contestants.h"

namespace spherechain::bench {

// A character whose spheres are each split into `parts`: too large for shared memory. False if the results differ from
// the CPU's.
bool bench_large(const std::string& folder, const std::string& name, std::uint32_t parts, const Ceilings& ceilings);

}  // namespace spherechain::bench
