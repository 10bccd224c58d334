// SPDX-License-Identifier: MIT
#include <cuda_runtime.h>

#include "crowd_body.h"
#include "crowd_launch.h"

namespace spherechain::cuda {
namespace {

static_assert(sizeof(Launch) <= 4096, "a kernel's arguments take at most that");

constexpr std::uint32_t kThreads = kWarpsMax * kLanes;
// How many blocks share a multiprocessor, which limits a thread's registers: for bones to 80; for spheres to 48, or on
// Turing, which has room for 1024 threads, to 64.
constexpr std::uint32_t kBoneBlocks = 3;
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ < 800
constexpr std::uint32_t kSphereBlocks = 4;
#else
constexpr std::uint32_t kSphereBlocks = 5;
#endif

struct DeviceBarriers {
  __device__ void block() const { __syncthreads(); }
  __device__ void warp() const { __syncwarp(); }
};
using Run = RunThread<DeviceBarriers>;

__device__ const GroupView& group_of_block(const Launch& launch) {
  std::uint32_t g = 0;
  while (g + 1 < launch.count && blockIdx.x >= launch.views[g + 1].first_block) {
    ++g;
  }
  return launch.views[g];
}

extern __shared__ Float4 shared_memory[];

__global__ void __launch_bounds__(kThreads, kSphereBlocks) run_spheres(const __grid_constant__ Launch launch) {
  const GroupView& v = group_of_block(launch);
  run_sphere_block(v, Shared(shared_memory, v.layout), Run{{threadIdx.x, kThreads, blockIdx.x - v.first_block}});
}

__global__ void __launch_bounds__(kThreads, kBoneBlocks) run_bones(const __grid_constant__ Launch launch) {
  const GroupView& v = group_of_block(launch);
  run_bone_block(v, Shared(shared_memory, v.layout), Run{{threadIdx.x, kThreads, blockIdx.x - v.first_block}});
}

__global__ void __launch_bounds__(kThreads) run_in_scratch(const __grid_constant__ Launch launch) {
  const GroupView& v = group_of_block(launch);
  run_blocks_in_scratch(v, blockIdx.x - v.first_block, [](std::uint32_t block) {
    return Run{{threadIdx.x, kThreads, block}};
  });
}

}  // namespace

Status enqueue(Kernel kernel, const Launch& launch, std::size_t shared_bytes_max, CUstream_st* stream) {
  constexpr std::size_t kAlways = 48 * 1024;  // more has to be asked for
  const void* const kernels[kKernels] = {reinterpret_cast<const void*>(run_spheres),
                                         reinterpret_cast<const void*>(run_bones),
                                         reinterpret_cast<const void*>(run_in_scratch)};
  const void* const function = kernels[static_cast<std::uint32_t>(kernel)];
  cudaError_t error = cudaSuccess;
  if (launch.shared_bytes > kAlways) {
    error =
        cudaFuncSetAttribute(function, cudaFuncAttributeMaxDynamicSharedMemorySize, static_cast<int>(shared_bytes_max));
  }
  if (error == cudaSuccess) {  // not by <<<>>>, which cannot tell its error from an older one of the program
    void* arguments[] = {const_cast<Launch*>(&launch)};
    error = cudaLaunchKernel(function, dim3(launch.blocks), dim3(kThreads), arguments, launch.shared_bytes, stream);
  }
  return status_of(error);
}

}  // namespace spherechain::cuda
