// SPDX-License-Identifier: MIT
#include "spherechain/cuda_host_crowd.h"

#include <cuda_runtime_api.h>

#include <algorithm>
#include <exception>
#include <vector>

#include "crowd_access.h"
#include "device_error.h"
#include "spherechain/cuda_device.h"

namespace spherechain::cuda {
namespace {

template <typename T>
class Array {
 public:
  Array() = default;
  Array(const Array&) = delete;
  Array& operator=(const Array&) = delete;
  ~Array() { cudaFree(data_); }

  Status allocate(std::size_t size) {
    cudaFree(data_);
    data_ = nullptr;
    size_ = 0;
    if (size == 0) {
      return Status::kOk;
    }
    const Status status = status_of(cudaMalloc(reinterpret_cast<void**>(&data_), size * sizeof(T)));
    size_ = status == Status::kOk ? size : 0;
    return status;
  }
  // At least as large.
  Status reserve(std::size_t size) { return size <= size_ ? Status::kOk : allocate(size); }
  Status put(const T* from, std::size_t count) {
    return status_of(cudaMemcpy(data_, from, count * sizeof(T), cudaMemcpyHostToDevice));
  }
  Status get(T* to, std::size_t count) const {
    return count == 0 || to == nullptr ? Status::kOk
                                       : status_of(cudaMemcpy(to, data_, count * sizeof(T), cudaMemcpyDeviceToHost));
  }
  T* data() const { return data_; }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

// The first that is not kOk.
template <typename... Steps>
Status first_failure(const Steps&... steps) {
  Status status = Status::kOk;
  static_cast<void>(((status = steps(), status == Status::kOk) && ...));
  return status;
}

}  // namespace

struct HostCrowd::Memory {
  ~Memory() {
    for (const cudaEvent_t event : {begin, end}) {
      if (event != nullptr) {
        cudaEventDestroy(event);
      }
    }
  }
  std::vector<std::uint64_t> words;
  Array<std::uint64_t> tables, starts, pair_count;
  Array<float> matrices, weights;
  Array<Sphere> spheres;
  Array<std::uint32_t> counts;
  Array<CrowdPair> pairs;
  Array<unsigned char> scratch;
  std::size_t scratch_bytes = 0;
  cudaEvent_t begin = nullptr, end = nullptr;
  std::vector<std::uint64_t> starts_there;
  std::vector<std::uint32_t> counts_there;
  std::vector<CrowdPair> pairs_there;
};

// The host's memory: where there is not as much, that is told as the device's is.
Status HostCrowd::allocate_here(const Asset& asset, std::size_t instances, std::size_t pair_capacity) noexcept {
  try {
    memory_ = new Memory;
    memory_->words.resize(CrowdTables::words_needed(asset));
    memory_->starts_there.resize(instances);
    memory_->counts_there.resize(instances);
    memory_->pairs_there.resize(pair_capacity);
  } catch (const std::exception&) {
    return status_of(cudaErrorMemoryAllocation);
  }
  return Status::kOk;
}

// For assets too large for the device's shared memory; the rest gets none.
Status HostCrowd::allocate_scratch(std::size_t instances) noexcept {
  constexpr std::size_t kMostBytes = std::size_t{1} << 30;  // but for a single block, which may need more
  int device = 0, most_shared = 0, multiprocessors = 0;
  Status status = status_of(cudaGetDevice(&device));
  if (status == Status::kOk) {
    status = status_of(cudaDeviceGetAttribute(&most_shared, cudaDevAttrMaxSharedMemoryPerBlockOptin, device));
  }
  if (status == Status::kOk) {
    status = status_of(cudaDeviceGetAttribute(&multiprocessors, cudaDevAttrMultiProcessorCount, device));
  }
  const std::size_t block = tables_.shared_bytes(true, tables_.morph_count() > 0, false, true);
  if (status != Status::kOk || block <= static_cast<std::size_t>(most_shared)) {
    return status;
  }
  const std::size_t useful =
      std::min<std::size_t>(2 * static_cast<std::size_t>(multiprocessors), (instances + 31) / 32);
  memory_->scratch_bytes = block * std::max<std::size_t>(1, std::min(useful, kMostBytes / block));
  return memory_->scratch.allocate(memory_->scratch_bytes);
}

void HostCrowd::close() noexcept {
  delete memory_;
  memory_ = nullptr;
  instances_ = 0;
}

Status HostCrowd::open(const Asset& asset, RadiusKind radius, const Filter* filter, std::size_t instances,
                       std::size_t pair_capacity) noexcept {
  close();
  if (!asset.is_open()) {
    return Status::kNotOpen;
  }
  if (asset.bone_count() == 0) {
    return Status::kNotInAsset;
  }
  constexpr std::size_t kMostInstances = 0x7FFFFFFF;  // CrowdJob's
  if (instances == 0 || instances > kMostInstances || pair_capacity == 0) {
    return Status::kBadArgument;
  }
  Status status = allocate_here(asset, instances, pair_capacity);
  const std::size_t n = asset.spheres().size;
  status = first_failure(
      [&] { return status; },
      [&] {
        return tables_.build(asset, radius, filter, {memory_->words.data(), memory_->words.size()});
      },
      [&] { return check_device(); }, [&] { return memory_->tables.allocate(memory_->words.size()); },
      [&] { return memory_->tables.put(memory_->words.data(), tables_.words()); },
      [&] { return memory_->spheres.allocate(instances * n); }, [&] { return memory_->counts.allocate(instances); },
      [&] { return memory_->starts.allocate(instances); }, [&] { return memory_->pair_count.allocate(1); },
      [&] { return memory_->pairs.allocate(pair_capacity); },
      [&] { return memory_->weights.allocate(instances * tables_.morph_count()); },
      [&] { return allocate_scratch(instances); }, [&] { return status_of(cudaEventCreate(&memory_->begin)); },
      [&] { return status_of(cudaEventCreate(&memory_->end)); });
  if (status != Status::kOk) {
    close();
    return status;
  }
  instances_ = instances;
  pair_capacity_ = pair_capacity;
  return Status::kOk;
}

Status HostCrowd::run() noexcept {
  if (!is_open()) {
    return Status::kNotOpen;
  }
  if (instance_count > instances_) {
    return Status::kBadArgument;
  }
  Memory& m = *memory_;
  CrowdGroup group;
  group.tables = &tables_;
  group.device_tables = m.tables.data();
  group.instance_count = instance_count;
  group.bones = bones;
  group.instance_stride = instance_stride;
  group.refitted = spheres == nullptr ? nullptr : m.spheres.data();
  group.counts = m.counts.data();
  group.starts = m.starts.data();
  group.pairs = m.pairs.data();
  group.pair_capacity = pair_capacity_;
  group.pair_count = m.pair_count.data();
  group.scratch = m.scratch.data();
  group.scratch_bytes = m.scratch_bytes;
  pair_count = 0;
  if (instance_count == 0) {
    return Status::kOk;
  }
  if (bones.data == nullptr) {
    return Status::kNullArgument;
  }
  GroupView checked;  // before anything is worked out from the arguments
  if (const Status refused = view_group(group, checked); refused != Status::kOk) {
    return refused;
  }
  const std::size_t floats =
      ((instance_count - 1) * instance_stride + (tables_.bone_count() - 1) * bones.stride + size_of(bones.layout)) /
      sizeof(float);
  const bool has_weights = morph_weights != nullptr && tables_.morph_count() > 0;
  const CrowdJob job{{&group, 1}, nullptr};
  std::uint64_t found = 0;
  const Status status = first_failure(
      [&] { return m.matrices.reserve(floats); }, [&] { return m.matrices.put(bones.data, floats); },
      [&] { return has_weights ? m.weights.put(morph_weights, instance_count * tables_.morph_count()) : Status::kOk; },
      [&] {
        group.bones.data = m.matrices.data();
        group.morph_weights = has_weights ? m.weights.data() : nullptr;
        return status_of(cudaEventRecord(m.begin));
      },
      [&] { return job.run(); }, [&] { return status_of(cudaEventRecord(m.end)); },
      [&] { return status_of(cudaEventSynchronize(m.end)); },
      [&] { return status_of(cudaEventElapsedTime(&device_milliseconds, m.begin, m.end)); },
      [&] { return m.counts.get(m.counts_there.data(), instance_count); },
      [&] { return m.starts.get(m.starts_there.data(), instance_count); }, [&] { return m.pair_count.get(&found, 1); },
      [&] { return m.spheres.get(spheres, spheres == nullptr ? 0 : instance_count * tables_.sphere_count()); });
  if (status != Status::kOk) {
    return status;
  }
  pair_count = static_cast<std::size_t>(found);
  if (counts != nullptr) {
    std::copy_n(m.counts_there.begin(), instance_count, counts);
  }
  if (pairs == nullptr) {
    return Status::kOk;
  }
  if (pair_count > pair_capacity_) {
    return Status::kOverflow;
  }
  const Status copied = m.pairs.get(m.pairs_there.data(), pair_count);
  CrowdPair* to = pairs;
  for (std::size_t i = 0; i < instance_count && copied == Status::kOk; ++i) {
    to = std::copy_n(m.pairs_there.begin() + static_cast<std::ptrdiff_t>(m.starts_there[i]), m.counts_there[i], to);
  }
  return copied;
}

}  // namespace spherechain::cuda
