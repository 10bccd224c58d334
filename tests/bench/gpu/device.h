// SPDX-License-Identifier: MIT
// Memory and time of the device, for the benchmark.
#pragma once

#include <cuda_runtime_api.h>

#include <cstdio>
#include <cstdlib>
#include <vector>

namespace spherechain::bench {

inline void must(cudaError_t error) {
  if (error != cudaSuccess) {
    std::fprintf(stderr, "spherechain_bench_gpu: CUDA: %s\n", cudaGetErrorString(error));
    std::exit(1);
  }
}

template <typename T>
class DeviceArray {
 public:
  DeviceArray() = default;
  explicit DeviceArray(std::size_t size) : size_(size) {
    must(cudaMalloc(reinterpret_cast<void**>(&data_), size * sizeof(T)));
    spoil();
  }
  explicit DeviceArray(const std::vector<T>& from) : DeviceArray(from.size()) {
    must(cudaMemcpy(data_, from.data(), size_ * sizeof(T), cudaMemcpyHostToDevice));
  }
  DeviceArray(DeviceArray&& other) noexcept : data_(other.data_), size_(other.size_) { other.data_ = nullptr; }
  DeviceArray& operator=(DeviceArray&&) = delete;
  ~DeviceArray() { cudaFree(data_); }

  T* data() const { return data_; }
  std::size_t size() const { return size_; }
  void spoil() { must(cudaMemset(data_, 0xDD, size_ * sizeof(T))); }
  std::vector<T> host() const {
    std::vector<T> out(size_);
    must(cudaMemcpy(out.data(), data_, size_ * sizeof(T), cudaMemcpyDeviceToHost));
    return out;
  }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

// Milliseconds on the device between start() and stop().
class DeviceClock {
 public:
  DeviceClock() {
    must(cudaEventCreate(&begin_));
    must(cudaEventCreate(&end_));
  }
  DeviceClock(const DeviceClock&) = delete;
  DeviceClock& operator=(const DeviceClock&) = delete;
  ~DeviceClock() {
    cudaEventDestroy(begin_);
    cudaEventDestroy(end_);
  }
  void start() { must(cudaEventRecord(begin_)); }
  double stop() {
    must(cudaEventRecord(end_));
    must(cudaEventSynchronize(end_));
    float milliseconds = 0;
    must(cudaEventElapsedTime(&milliseconds, begin_, end_));
    return milliseconds;
  }

 private:
  cudaEvent_t begin_ = nullptr, end_ = nullptr;
};

}  // namespace spherechain::bench
