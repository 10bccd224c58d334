// SPDX-License-Identifier: MIT
#include "crowd_kernel.h"

namespace spherechain::cuda {
namespace {

__global__ void __launch_bounds__(kThreads) run_crowd_in_scratch(const __grid_constant__ Launch launch) {
  const GroupView& v = group_of_block(launch);
  run_blocks_in_scratch(v, blockIdx.x - v.first_block, [](std::uint32_t block) {
    return RunStep{{threadIdx.x, kThreads, block}};
  });
}

}  // namespace

Status launch_in_scratch(const LaunchPlan& plan, CUstream_st* stream) {
  return launch(run_crowd_in_scratch, plan.in_scratch, plan.scratch_blocks, 0, stream);
}

}  // namespace spherechain::cuda
