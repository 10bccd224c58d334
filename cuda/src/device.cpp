// SPDX-License-Identifier: MIT
// The calls of CUDA's runtime for enqueue_crowds().
#include <cuda_runtime_api.h>

#include "crowd_launch.h"
#include "runtime/src/base/status.h"

namespace spherechain::cuda {
namespace {

thread_local cudaError_t last_error = cudaSuccess;

}  // namespace

Status status_of(int cuda_error) {
  const auto error = static_cast<cudaError_t>(cuda_error);
  if (error == cudaSuccess) {
    return done();
  }
  last_error = error;
  const bool is_missing = error == cudaErrorNoDevice || error == cudaErrorInsufficientDriver ||
                          error == cudaErrorSystemDriverMismatch || error == cudaErrorNoKernelImageForDevice ||
                          error == cudaErrorSystemNotReady || error == cudaErrorCompatNotSupportedOnDevice;
  return refuse(is_missing ? SC_NO_DEVICE : SC_DEVICE_FAILED, SC_FIELD_NONE);
}

Status find_limits(DeviceLimits& limits) {
  int device = 0, bytes = 0, multiprocessors = 0;
  cudaError_t error = cudaGetDevice(&device);
  if (error == cudaSuccess) {
    error = cudaDeviceGetAttribute(&bytes, cudaDevAttrMaxSharedMemoryPerBlockOptin, device);
  }
  if (error == cudaSuccess) {
    error = cudaDeviceGetAttribute(&multiprocessors, cudaDevAttrMultiProcessorCount, device);
  }
  limits = {static_cast<std::size_t>(bytes), static_cast<std::size_t>(multiprocessors)};
  return status_of(error);
}

Status check_device() noexcept {
  int count = 0;
  const cudaError_t error = cudaGetDeviceCount(&count);
  return status_of(error == cudaSuccess && count == 0 ? cudaErrorNoDevice : error);
}

const char* last_device_error() noexcept { return cudaGetErrorString(last_error); }

Status enqueue_crowds(const CrowdGroup* groups, std::size_t group_count, CUstream_st* stream) noexcept {
  Launch all;
  LaunchPlan plan;
  DeviceLimits limits{};
  Status status = view_groups(groups, group_count, all);
  if (status == SC_OK && all.count > 0) {
    status = find_limits(limits);
  }
  if (status == SC_OK) {
    status = plan_launches(all, limits.shared_bytes_max, plan);
  }
  for (std::size_t g = 0; g < group_count && status == SC_OK; ++g) {
    if (groups[g].pairs != nullptr) {
      status = status_of(cudaMemsetAsync(groups[g].pair_count, 0, sizeof *groups[g].pair_count, stream));
    }
  }
  for (std::uint32_t k = 0; k < kKernels && status == SC_OK; ++k) {
    if (plan.launches[k].count > 0) {
      status = enqueue(static_cast<Kernel>(k), plan.launches[k], limits.shared_bytes_max, stream);
    }
  }
  return status;
}

}  // namespace spherechain::cuda
