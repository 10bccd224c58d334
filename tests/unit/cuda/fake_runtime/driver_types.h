// SPDX-License-Identifier: MIT
// In place of the CUDA Toolkit's header of that name: see cuda_runtime_api.h beside it.
#pragma once

struct CUstream_st;
struct CUevent_st;
using cudaStream_t = CUstream_st*;
using cudaEvent_t = CUevent_st*;

// Numbers of our own: nothing may depend on them.
enum cudaError_t {
  cudaSuccess,
  cudaErrorMemoryAllocation,
  cudaErrorIllegalAddress,
  cudaErrorNoDevice,
  cudaErrorInsufficientDriver,
  cudaErrorSystemDriverMismatch,
  cudaErrorNoKernelImageForDevice,
  cudaErrorSystemNotReady,
  cudaErrorCompatNotSupportedOnDevice
};
enum cudaMemcpyKind { cudaMemcpyHostToDevice, cudaMemcpyDeviceToHost };
enum cudaDeviceAttr { cudaDevAttrMaxSharedMemoryPerBlockOptin, cudaDevAttrMultiProcessorCount };
