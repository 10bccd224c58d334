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
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ < 800
inline constexpr std::uint32_t kSphereBlocksAtOnce = 4;  // Turing's 1024 threads
#else
inline constexpr std::uint32_t kSphereBlocksAtOnce = 5;  // 48
#endif

// Not by <<<>>>, whose error is told apart from an older one of the program's only by who asks each time.
inline Status launch(void (*kernel)(Launch), const Launch& groups, std::uint32_t blocks, std::size_t shared_bytes,
                     cudaStream_t stream) {
  void* arguments[] = {const_cast<Launch*>(&groups)};
  return status_of(cudaLaunchKernel(reinterpret_cast<const void*>(kernel), dim3(blocks), dim3(kThreads), arguments,
                                    shared_bytes, stream));
}

struct DeviceBarriers {
  __device__ void block() const { __syncthreads(); }
  __device__ void warp() const { __syncwarp(); }
};
using RunStep = RunThread<DeviceBarriers>;

__device__ inline const GroupView& group_of_block(const Launch& launch) {
  std::uint32_t g = 0;
  while (g + 1 < launch.count && blockIdx.x >= launch.views[g + 1].first_block) {
    ++g;
  }
  return launch.views[g];
}

}  // namespace spherechain::cuda
