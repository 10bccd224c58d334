// SPDX-License-Identifier: MIT
#include <cuda_runtime_api.h>

#include <cstdio>
#include <cstdlib>
#include <deque>

#include "crowd_runs.h"

namespace spherechain::test {
namespace {

void must(cudaError_t error) {
  if (error != cudaSuccess) {
    std::fprintf(stderr, "CUDA: %s\n", cudaGetErrorString(error));
    std::abort();
  }
}

// Memory of the device, sized exactly, so that compute-sanitizer sees what goes past its end.
class Buffer {
 public:
  explicit Buffer(std::size_t bytes) : bytes_(bytes) {
    if (bytes > 0) must(cudaMalloc(&data_, bytes));
    if (bytes > 0) must(cudaMemset(data_, kDirty, bytes));
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  ~Buffer() { cudaFree(data_); }

  template <typename T>
  T* data() const {
    return static_cast<T*>(data_);
  }
  template <typename T>
  void get(std::vector<T>& to) const {
    to.resize(bytes_ / sizeof(T));
    if (bytes_ > 0) must(cudaMemcpy(to.data(), data_, bytes_, cudaMemcpyDeviceToHost));
  }

 private:
  void* data_ = nullptr;
  std::size_t bytes_;
};

struct Buffers {
  std::deque<Buffer> all;

  template <typename T>
  const T* put(const std::vector<T>& from) {
    const Buffer& to = all.emplace_back(from.size() * sizeof(T));
    if (!from.empty()) must(cudaMemcpy(to.data<T>(), from.data(), from.size() * sizeof(T), cudaMemcpyHostToDevice));
    return to.data<T>();
  }
  template <typename T>
  const Buffer& take(std::size_t count) {
    return all.emplace_back(count * sizeof(T));
  }
};

struct Outputs {
  const Buffer &refitted, &counts, &bits, &starts, &pairs, &pair_count;
};

}  // namespace

CrowdRun run_crowd(const std::vector<GroupInput>& groups) {
  Buffers buffers;
  std::vector<cuda::CrowdGroup> device;
  std::vector<Outputs> outputs;
  for (const GroupInput& in : groups) {
    cuda::CrowdGroup& group =
        device.emplace_back(inputs_of(in, buffers.put(in.table), buffers.put(in.spheres), buffers.put(in.matrices)));
    const cuda::TableHeader header = header_of(in);
    const std::size_t count = in.instance_count, words = in.wants_bits ? header.bit_words * count : 0;
    const Outputs& out = outputs.emplace_back(Outputs{
        buffers.take<Sphere>(in.wants_spheres && !in.matrices.empty() ? header.sphere_count * count : 0),
        buffers.take<std::uint32_t>(count), buffers.take<std::uint64_t>(words), buffers.take<std::uint64_t>(count),
        buffers.take<CrowdPair>(in.pair_capacity), buffers.take<std::uint64_t>(1)});
    group.refitted = out.refitted.data<Sphere>();
    group.counts = out.counts.data<std::uint32_t>();
    group.bits = out.bits.data<std::uint64_t>();
    group.starts = out.starts.data<std::uint64_t>();
    group.pairs = out.pairs.data<CrowdPair>();
    group.pair_capacity = in.pair_capacity;
    group.pair_count = out.pair_count.data<std::uint64_t>();
    group.scratch = buffers.take<unsigned char>(in.scratch_bytes).data<void>();
    group.scratch_bytes = in.scratch_bytes;
  }
  CrowdRun run{cuda::enqueue_crowds(device.data(), device.size(), nullptr), std::vector<GroupOutput>(groups.size())};
  must(cudaDeviceSynchronize());
  for (std::size_t g = 0; g < groups.size(); ++g) {
    GroupOutput& to = run.groups[g];
    outputs[g].refitted.get(to.refitted);
    outputs[g].counts.get(to.counts);
    outputs[g].bits.get(to.bits);
    outputs[g].starts.get(to.starts);
    outputs[g].pairs.get(to.pairs);
    std::vector<std::uint64_t> pair_count;
    outputs[g].pair_count.get(pair_count);
    to.pair_count = pair_count[0];
  }
  return run;
}

bool can_run(const char*& where) {
  static cudaDeviceProp properties;
  if (cuda::check_device() != SC_OK) {
    std::printf("skipped: %s\n", cuda::last_device_error());
    return false;
  }
  must(cudaGetDeviceProperties(&properties, 0));
  where = properties.name;
  return true;
}

}  // namespace spherechain::test
