// SPDX-License-Identifier: MIT
#pragma once

#include <driver_types.h>

#include "spherechain/status.h"

namespace spherechain::cuda {

// kOk, kNoDevice or kDeviceFailed; what it says is kept for last_device_error().
Status status_of(cudaError_t error);

}  // namespace spherechain::cuda
