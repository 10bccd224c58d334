// SPDX-License-Identifier: MIT
// The kernels' blocks on the CPU: one after another, and within each step the threads, in any order: what needs a
// barrier and has none shows.
#pragma once

#include <random>

#include "crowd_access.h"
#include "crowd_runs.h"

namespace spherechain::test {

void run_in_shared(const cuda::GroupView& view, std::mt19937& random);
void run_in_scratch(const cuda::GroupView& view, std::mt19937& random);

}  // namespace spherechain::test
