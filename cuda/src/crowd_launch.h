// SPDX-License-Identifier: MIT
// The kernels, enqueued. kOk, kNoDevice or kDeviceFailed.
#pragma once

#include "crowd_access.h"

struct CUstream_st;

namespace spherechain::cuda {

// `most_shared_bytes`: what a block of the device may have.
Status launch_in_shared(const LaunchPlan& plan, std::size_t most_shared_bytes, CUstream_st* stream);
Status launch_in_scratch(const LaunchPlan& plan, CUstream_st* stream);

}  // namespace spherechain::cuda
