// SPDX-License-Identifier: MIT
// The kernels' blocks on the CPU: one after another, and within each step the threads, in any order: what needs a
// barrier and has none shows.
#pragma once

#include <random>

#include "crowd_launch.h"
#include "crowd_runs.h"

namespace spherechain::test {

void run_in_shared(const cuda::GroupView& view, std::mt19937& random);
void run_in_scratch(const cuda::GroupView& view, std::mt19937& random);

inline void run_kernel(cuda::Kernel kernel, const cuda::Launch& launch, std::mt19937& random) {
  for (std::uint32_t g = 0; g < launch.count; ++g) {
    kernel == cuda::Kernel::kScratch ? run_in_scratch(launch.views[g], random) : run_in_shared(launch.views[g], random);
  }
}

}  // namespace spherechain::test
