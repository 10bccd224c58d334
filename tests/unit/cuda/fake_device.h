// SPDX-License-Identifier: MIT
// The state of the device behind fake_runtime/cuda_runtime_api.h, and the result of its next call.
#pragma once

#include <cstddef>

#include "fake_runtime/driver_types.h"

namespace spherechain::test {

struct FakeDevice {
  int count = 1;  // devices
  int most_shared_bytes = 227 * 1024, multiprocessors = 2;
  cudaError_t error = cudaSuccess;  // of the call after `calls_before_error` more, and of those after it
  std::size_t calls_before_error = 0;

  std::size_t calls = 0;         // so far; freeing is none
  std::size_t objects = 0;       // events, and pieces of memory, not freed
  std::size_t bytes = 0;         // of the latter
  std::size_t launches[3] = {};  // by cuda::Kernel
};
extern FakeDevice fake_device;

}  // namespace spherechain::test
