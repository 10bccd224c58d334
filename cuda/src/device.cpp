// SPDX-License-Identifier: MIT
// What talks to CUDA's runtime for a CrowdJob.
#include <cuda_runtime_api.h>

#include "crowd_launch.h"

namespace spherechain::cuda {
namespace {

thread_local cudaError_t last_error = cudaSuccess;

Status find_shared_bytes_max(std::size_t& bytes) {
  int device = 0, most = 0;
  cudaError_t error = cudaGetDevice(&device);
  if (error == cudaSuccess) {
    error = cudaDeviceGetAttribute(&most, cudaDevAttrMaxSharedMemoryPerBlockOptin, device);
  }
  bytes = static_cast<std::size_t>(most);
  return status_of(error);
}

}  // namespace

Status status_of(int cuda_error) {
  const auto error = static_cast<cudaError_t>(cuda_error);
  if (error == cudaSuccess) {
    return Status::kOk;
  }
  last_error = error;
  return error == cudaErrorNoDevice || error == cudaErrorInsufficientDriver || error == cudaErrorSystemDriverMismatch ||
                 error == cudaErrorNoKernelImageForDevice || error == cudaErrorSystemNotReady ||
                 error == cudaErrorCompatNotSupportedOnDevice
             ? Status::kNoDevice
             : Status::kDeviceFailed;
}

Status check_device() noexcept {
  int count = 0;
  const cudaError_t error = cudaGetDeviceCount(&count);
  return status_of(error == cudaSuccess && count == 0 ? cudaErrorNoDevice : error);
}

const char* last_device_error() noexcept { return cudaGetErrorString(last_error); }

Status CrowdJob::run() const noexcept {
  Launch all;
  LaunchPlan plan;
  std::size_t shared_bytes_max = 0;
  Status status = view_groups(groups, all);
  if (status == Status::kOk && all.count > 0) {
    status = find_shared_bytes_max(shared_bytes_max);
  }
  if (status == Status::kOk) {
    status = plan_launches(all, shared_bytes_max, plan);
  }
  for (const CrowdGroup& group : groups) {
    if (status == Status::kOk && group.pairs != nullptr) {
      status = status_of(cudaMemsetAsync(group.pair_count, 0, sizeof *group.pair_count, stream));
    }
  }
  for (std::uint32_t k = 0; k < kKernels && status == Status::kOk; ++k) {
    if (plan.launches[k].count > 0) {
      status = enqueue(static_cast<Kernel>(k), plan.launches[k], shared_bytes_max, stream);
    }
  }
  return status;
}

}  // namespace spherechain::cuda
