// SPDX-License-Identifier: MIT
// What the kernels have in common: for CUDA's compiler only.
#pragma once

#include <cuda_runtime.h>

#include "crowd_body.h"
#include "crowd_launch.h"
#include "device_error.h"

namespace spherechain::cuda {

static_assert(sizeof(Launch) <= 4096, "what a kernel's arguments may take");

inline constexpr std::uint32_t kThreads = kMostWarps * kLanes;
inline constexpr std::uint32_t kBlocksAtOnce = 3;  // a multiprocessor: leaves a thread 80 registers

struct RunStep {
  Place at;

  template <typename Step>
  __device__ void operator()(const Step& step) const {
    step(at);
    __syncthreads();
  }
};

__device__ inline const GroupView& group_of_block(const Launch& launch) {
  std::uint32_t g = 0;
  while (g + 1 < launch.count && blockIdx.x >= launch.views[g + 1].first_block) {
    ++g;
  }
  return launch.views[g];
}

}  // namespace spherechain::cuda
