// SPDX-License-Identifier: MIT
#include "crowd_kernel.h"

namespace spherechain::cuda {
namespace {

struct RunInShared {
  template <typename Block>
  __device__ static void run(const Launch& launch, const Block& block) {
    extern __shared__ Float4 memory[];
    const GroupView& v = group_of_block(launch);
    block(v, Shared(memory, v.layout), RunStep{{threadIdx.x, kThreads, blockIdx.x - v.first_block}});
  }
};

// Where all groups of a launch go the same way.
template <Way kWay>
__global__ void __launch_bounds__(kThreads, kWay == Way::kSpheres ? kSphereBlocksAtOnce : kBlocksAtOnce)
    run_crowd(const __grid_constant__ Launch launch) {
  RunInShared::run(
      launch, [](const GroupView& v, const Shared& shared, const RunStep& run) { run_block<kWay>(v, shared, run); });
}

// All ways in one, and the slowest.
__global__ void __launch_bounds__(kThreads, kBlocksAtOnce) run_mixed_crowd(const __grid_constant__ Launch launch) {
  RunInShared::run(launch,
                   [](const GroupView& v, const Shared& shared, const RunStep& run) { run_any_block(v, shared, run); });
}

using Kernel = void (*)(Launch);

Kernel kernel_of(const Launch& launch) {
  const Way way = way_of(launch.views[0]);
  for (std::uint32_t g = 1; g < launch.count; ++g) {
    if (way_of(launch.views[g]) != way) {
      return run_mixed_crowd;
    }
  }
  return way == Way::kSpheres   ? run_crowd<Way::kSpheres>
         : way == Way::kBones   ? run_crowd<Way::kBones>
         : way == Way::kMoments ? run_crowd<Way::kMoments>
         : way == Way::kCovers  ? run_crowd<Way::kCovers>
                                : run_mixed_crowd;
}

}  // namespace

Status launch_in_shared(const LaunchPlan& plan, std::size_t most_shared_bytes, CUstream_st* stream) {
  constexpr std::size_t kAlways = 48 * 1024;  // more has to be asked for, which costs no more than looking it up would
  const Kernel kernel = kernel_of(plan.in_shared);
  if (plan.shared_bytes > kAlways) {
    const Status status = status_of(
        cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, static_cast<int>(most_shared_bytes)));
    if (status != Status::kOk) {
      return status;
    }
  }
  return launch(kernel, plan.in_shared, plan.shared_blocks, plan.shared_bytes, stream);
}

}  // namespace spherechain::cuda
