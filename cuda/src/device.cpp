// SPDX-License-Identifier: MIT
#include "spherechain/cuda_device.h"

#include <cuda_runtime_api.h>

#include "device_error.h"

namespace spherechain::cuda {
namespace {

thread_local cudaError_t last_error = cudaSuccess;

}  // namespace

Status status_of(cudaError_t error) {
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

}  // namespace spherechain::cuda
