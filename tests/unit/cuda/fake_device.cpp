// SPDX-License-Identifier: MIT
#include "fake_device.h"

#include <cstdlib>
#include <cstring>
#include <map>

#include "crowd_launch.h"
#include "emulated_blocks.h"
#include "fake_runtime/cuda_runtime_api.h"

namespace spherechain::test {

FakeDevice fake_device;

namespace {

std::map<void*, std::size_t> memory_sizes;

cudaError_t call() {
  ++fake_device.calls;
  if (fake_device.error != cudaSuccess && fake_device.calls_before_error > 0) {
    --fake_device.calls_before_error;
    return cudaSuccess;
  }
  return fake_device.error;
}

}  // namespace
}  // namespace spherechain::test

using namespace spherechain::test;

cudaError_t cudaGetDeviceProperties(cudaDeviceProp* properties, int) {
  *properties = {fake_device.multiprocessors, static_cast<std::size_t>(fake_device.most_shared_bytes)};
  return call();
}

cudaError_t cudaGetDeviceCount(int* count) {
  *count = fake_device.count;
  return call();
}

cudaError_t cudaGetDevice(int* device) {
  *device = 0;
  return call();
}

cudaError_t cudaDeviceGetAttribute(int* value, cudaDeviceAttr attribute, int) {
  *value = attribute == cudaDevAttrMultiProcessorCount ? fake_device.multiprocessors : fake_device.most_shared_bytes;
  return call();
}

cudaError_t cudaMalloc(void** memory, std::size_t bytes) {
  const cudaError_t error = call();
  if (error != cudaSuccess) return error;
  *memory = std::aligned_alloc(256, (bytes + 255) / 256 * 256);
  if (*memory == nullptr) return cudaErrorMemoryAllocation;
  std::memset(*memory, kDirty, bytes);
  memory_sizes[*memory] = bytes;
  fake_device.bytes += bytes;
  ++fake_device.objects;
  return cudaSuccess;
}

cudaError_t cudaFree(void* memory) {
  if (memory == nullptr) return cudaSuccess;
  fake_device.bytes -= memory_sizes.at(memory);
  memory_sizes.erase(memory);
  --fake_device.objects;
  std::free(memory);
  return cudaSuccess;
}

cudaError_t cudaMemcpy(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind) {
  const cudaError_t error = call();
  if (error != cudaSuccess || bytes == 0) return error;
  const void* there = kind == cudaMemcpyHostToDevice ? to : from;
  const auto found = memory_sizes.find(const_cast<void*>(there));
  if (found == memory_sizes.end() || bytes > found->second) return cudaErrorIllegalAddress;
  std::memcpy(to, from, bytes);
  return cudaSuccess;
}

cudaError_t cudaMemset(void* memory, int value, std::size_t bytes) {
  const cudaError_t error = call();
  if (error == cudaSuccess) std::memset(memory, value, bytes);
  return error;
}

cudaError_t cudaMemsetAsync(void* memory, int value, std::size_t bytes, cudaStream_t) {
  return cudaMemset(memory, value, bytes);
}

cudaError_t cudaEventCreate(cudaEvent_t* event) {
  const cudaError_t error = call();
  if (error != cudaSuccess) return error;
  *event = reinterpret_cast<cudaEvent_t>(new int(0));
  ++fake_device.objects;
  return cudaSuccess;
}

cudaError_t cudaEventDestroy(cudaEvent_t event) {
  if (event == nullptr) return cudaErrorIllegalAddress;
  delete reinterpret_cast<int*>(event);
  --fake_device.objects;
  return cudaSuccess;
}

cudaError_t cudaEventRecord(cudaEvent_t) { return call(); }
cudaError_t cudaEventSynchronize(cudaEvent_t) { return call(); }

cudaError_t cudaEventElapsedTime(float* milliseconds, cudaEvent_t, cudaEvent_t) {
  *milliseconds = 0.25F;
  return call();
}

const char* cudaGetErrorString(cudaError_t error) {
  return error == cudaSuccess ? "no error" : "the fake device failed";
}

namespace spherechain::cuda {

Status enqueue(Kernel kernel, const Launch& launch, std::size_t shared_bytes_max, CUstream_st*) {
  ++fake_device.launches[static_cast<std::size_t>(kernel)];
  const Status status = status_of(call());
  if (status != SC_OK) return status;
  if (launch.shared_bytes > shared_bytes_max) return {SC_DEVICE_FAILED, SC_FIELD_NONE};
  std::mt19937 random(1);
  run_kernel(kernel, launch, random);
  return status;
}

}  // namespace spherechain::cuda
