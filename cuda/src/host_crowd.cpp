// SPDX-License-Identifier: MIT
#include "spherechain/cuda_host_crowd.h"

#include <cuda_runtime_api.h>

#include <algorithm>
#include <new>
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
    size_ = size;
    return size == 0 ? Status::kOk : status_of(cudaMalloc(reinterpret_cast<void**>(&data_), size * sizeof(T)));
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
    cudaEventDestroy(begin);
    cudaEventDestroy(end);
  }
  std::vector<std::uint64_t> words;
  Array<std::uint64_t> tables, starts, pair_count;
  Array<float> matrices, weights;
  Array<Sphere> spheres;
  Array<std::uint32_t> counts;
  Array<CrowdPair> pairs;
  cudaEvent_t begin = nullptr, end = nullptr;
  std::vector<std::uint64_t> starts_there;
  std::vector<std::uint32_t> counts_there;
  std::vector<CrowdPair> pairs_there;
};

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
  if (instances == 0 || pair_capacity == 0) {
    return Status::kBadArgument;
  }
  Status status = check_device();
  if (status != Status::kOk) {
    return status;
  }
  memory_ = new Memory;
  Memory& m = *memory_;
  m.words.resize(CrowdTables::words_needed(asset));
  m.starts_there.resize(instances);
  m.counts_there.resize(instances);
  m.pairs_there.resize(pair_capacity);
  const std::size_t n = asset.spheres().size;
  status = first_failure(
      [&] {
        return tables_.build(asset, radius, filter, {m.words.data(), m.words.size()});
      },
      [&] { return m.tables.allocate(m.words.size()); }, [&] { return m.tables.put(m.words.data(), tables_.words()); },
      [&] { return m.spheres.allocate(instances * n); }, [&] { return m.counts.allocate(instances); },
      [&] { return m.starts.allocate(instances); }, [&] { return m.pair_count.allocate(1); },
      [&] { return m.pairs.allocate(pair_capacity); },
      [&] { return m.weights.allocate(instances * tables_.morph_count()); },
      [&] { return status_of(cudaEventCreate(&m.begin)); }, [&] { return status_of(cudaEventCreate(&m.end)); });
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
