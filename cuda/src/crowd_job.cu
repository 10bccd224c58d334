// SPDX-License-Identifier: MIT
#include <cuda_runtime.h>

#include "crowd_access.h"
#include "crowd_body.h"
#include "device_error.h"

namespace spherechain::cuda {
namespace {

constexpr std::uint32_t kThreads = kMostWarps * kLanes;
constexpr std::uint32_t kBlocksAtOnce = 3;  // a multiprocessor: leaves a thread 80 registers

struct Groups {
  GroupView views[CrowdJob::kMostGroups];
  std::uint32_t count;
};

struct RunStep {
  Place at;

  template <typename Step>
  __device__ void operator()(const Step& step) const {
    step(at);
    __syncthreads();
  }
};

// What the groups of a launch have in common; kAny has all the ways in one, and is the slowest.
enum class Input { kSpheres, kBones, kAny };

template <Input kInput>
__global__ void __launch_bounds__(kThreads, kBlocksAtOnce) run_crowd(const __grid_constant__ Groups groups) {
  extern __shared__ Float4 memory[];
  std::uint32_t g = 0;
  while (g + 1 < groups.count && blockIdx.x >= groups.views[g + 1].first_block) {
    ++g;
  }
  const GroupView& v = groups.views[g];
  const Shared shared(memory, shared_layout(v));
  const RunStep run{{threadIdx.x, kThreads, blockIdx.x - v.first_block}};
  if (kInput == Input::kSpheres || (kInput == Input::kAny && v.matrices == nullptr)) {
    run_block<false, false>(v, shared, run);
  } else if (kInput == Input::kBones || v.morph_weights == nullptr) {
    run_block<true, false>(v, shared, run);
  } else {
    run_block<true, true>(v, shared, run);
  }
}

using Kernel = void (*)(Groups);

Input input_of(const GroupView& v) {
  return v.matrices == nullptr ? Input::kSpheres : v.morph_weights == nullptr ? Input::kBones : Input::kAny;
}

Kernel kernel_of(const Groups& groups) {
  const Input input = input_of(groups.views[0]);
  for (std::uint32_t g = 1; g < groups.count; ++g) {
    if (input_of(groups.views[g]) != input) {
      return run_crowd<Input::kAny>;
    }
  }
  return input == Input::kSpheres ? run_crowd<Input::kSpheres>
         : input == Input::kBones ? run_crowd<Input::kBones>
                                  : run_crowd<Input::kAny>;
}

// More than a launch gets without asking. Asking costs no more than looking it up would.
Status allow_shared_memory(Kernel kernel, std::size_t bytes) {
  constexpr std::size_t kAlways = 48 * 1024;
  if (bytes <= kAlways) {
    return Status::kOk;
  }
  int device = 0, most = 0;
  cudaError_t error = cudaGetDevice(&device);
  if (error == cudaSuccess) {
    error = cudaDeviceGetAttribute(&most, cudaDevAttrMaxSharedMemoryPerBlockOptin, device);
  }
  if (error == cudaSuccess && bytes > static_cast<std::size_t>(most)) {
    return Status::kDeviceTooSmall;
  }
  if (error == cudaSuccess) {
    error = cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, most);
  }
  return status_of(error);
}

}  // namespace

Status CrowdJob::run() const noexcept {
  if (groups.data == nullptr && groups.size > 0) {
    return Status::kNullArgument;
  }
  if (groups.size > kMostGroups) {
    return Status::kBadArgument;
  }
  Groups all{};
  std::uint32_t blocks = 0;
  std::size_t bytes = 0;
  for (const CrowdGroup& group : groups) {
    GroupView& view = all.views[all.count];
    const Status status = view_group(group, view);
    if (status != Status::kOk) {
      return status;
    }
    if (view.instance_count > 0) {
      view.first_block = blocks;
      blocks += blocks_of(view);
      const std::size_t own = shared_layout(view).size;
      bytes = own > bytes ? own : bytes;
      ++all.count;
    }
  }
  const Kernel kernel = kernel_of(all);
  Status status = allow_shared_memory(kernel, bytes);
  for (const CrowdGroup& group : groups) {
    if (status == Status::kOk && group.pairs != nullptr) {
      status = status_of(cudaMemsetAsync(group.pair_count, 0, sizeof *group.pair_count, stream));
    }
  }
  if (status != Status::kOk || all.count == 0) {
    return status;
  }
  kernel<<<blocks, kThreads, bytes, stream>>>(all);
  return status_of(cudaGetLastError());
}

}  // namespace spherechain::cuda
