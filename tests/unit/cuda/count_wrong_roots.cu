// SPDX-License-Identifier: MIT
#include <cuda_runtime.h>

#include "crowd_primitives.h"

namespace spherechain::test {
namespace {

__global__ void compare_roots(unsigned first, unsigned last, unsigned long long* wrong) {
  for (unsigned bits = first + blockIdx.x * blockDim.x + threadIdx.x; bits <= last; bits += gridDim.x * blockDim.x) {
    const float x = __uint_as_float(bits);
    if (cuda::usual_root(x) != __fsqrt_rn(x)) {
      atomicAdd(wrong, 1ULL);
    }
  }
}

}  // namespace

// Over all floats from kRootMin to kRootMax; -1 where the device fails.
long long count_wrong_roots() {
  unsigned first = 0, last = 0;
  const float least = cuda::kRootMin, most = cuda::kRootMax;
  static_assert(sizeof first == sizeof least, "");
  memcpy(&first, &least, sizeof first);
  memcpy(&last, &most, sizeof last);
  unsigned long long* wrong = nullptr;
  unsigned long long count = 0;
  if (cudaMalloc(&wrong, sizeof *wrong) != cudaSuccess || cudaMemset(wrong, 0, sizeof *wrong) != cudaSuccess) {
    return -1;
  }

  compare_roots<<<1024, 256>>>(first, last, wrong);
  const cudaError_t error = cudaMemcpy(&count, wrong, sizeof count, cudaMemcpyDeviceToHost);

  cudaFree(wrong);
  return error == cudaSuccess ? static_cast<long long>(count) : -1;
}

}  // namespace spherechain::test
