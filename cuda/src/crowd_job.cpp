// SPDX-License-Identifier: MIT
#include <cuda_runtime_api.h>

#include "crowd_launch.h"
#include "device_error.h"

namespace spherechain::cuda {
namespace {

Status most_shared_bytes(std::size_t& bytes) {
  int device = 0, most = 0;
  cudaError_t error = cudaGetDevice(&device);
  if (error == cudaSuccess) {
    error = cudaDeviceGetAttribute(&most, cudaDevAttrMaxSharedMemoryPerBlockOptin, device);
  }
  bytes = static_cast<std::size_t>(most);
  return status_of(error);
}

}  // namespace

Status CrowdJob::run() const noexcept {
  Launch all;
  LaunchPlan plan{};
  std::size_t most = 0;
  Status status = view_groups(groups, all);
  if (status == Status::kOk && all.count > 0) {
    status = most_shared_bytes(most);
  }
  if (status == Status::kOk) {
    status = plan_launches(all, most, plan);
  }
  for (const CrowdGroup& group : groups) {
    if (status == Status::kOk && group.pairs != nullptr) {
      status = status_of(cudaMemsetAsync(group.pair_count, 0, sizeof *group.pair_count, stream));
    }
  }
  if (status == Status::kOk && plan.in_shared.count > 0) {
    status = launch_in_shared(plan, most, stream);
  }
  if (status == Status::kOk && plan.in_scratch.count > 0) {
    status = launch_in_scratch(plan, stream);
  }
  return status;
}

}  // namespace spherechain::cuda
