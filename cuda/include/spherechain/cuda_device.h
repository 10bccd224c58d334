// SPDX-License-Identifier: MIT
#pragma once

#include "spherechain/status.h"

namespace spherechain::cuda {

// kOk where the current CUDA device can run the jobs; kNoDevice where there is none, or no driver, or one too old for
// this library. A program that links the CUDA backend runs everywhere; only its jobs need a device.
Status check_device() noexcept;

// What the CUDA runtime said of the last job of this thread that failed with kNoDevice or kDeviceFailed, in English;
// "no error" where none did. Never null.
const char* last_device_error() noexcept;

}  // namespace spherechain::cuda
