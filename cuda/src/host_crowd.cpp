// SPDX-License-Identifier: MIT
#include <cuda_runtime_api.h>

#include <algorithm>
#include <exception>
#include <vector>

#include "crowd_launch.h"
#include "runtime/src/base/status.h"
#include "runtime/src/pose/pose.h"

namespace spherechain::cuda {
namespace {

// An array on the device.
template <typename T>
class Array {
 public:
  Array() = default;
  Array(const Array&) = delete;
  Array& operator=(const Array&) = delete;
  ~Array() { cudaFree(data_); }

  // At least that large; what it held is lost if it grows.
  Status reserve(std::size_t size) {
    if (size <= size_) {
      return done();
    }
    cudaFree(data_);
    data_ = nullptr;
    size_ = 0;
    const Status status = status_of(cudaMalloc(reinterpret_cast<void**>(&data_), size * sizeof(T)));
    size_ = status == SC_OK ? size : 0;
    return status;
  }
  Status assign(const T* from, std::size_t count) {
    const Status status = reserve(count);
    return status != SC_OK ? status : status_of(cudaMemcpy(data_, from, count * sizeof(T), cudaMemcpyHostToDevice));
  }
  Status get(T* to, std::size_t count) const {
    return count == 0 || to == nullptr ? done()
                                       : status_of(cudaMemcpy(to, data_, count * sizeof(T), cudaMemcpyDeviceToHost));
  }
  T* data() const { return data_; }
  std::size_t size() const { return size_; }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

// Runs the steps up to the first that is not SC_OK, and returns its status.
template <typename... Steps>
Status first_failure(const Steps&... steps) {
  Status status = done();
  static_cast<void>(((status = steps(), status == SC_OK) && ...));
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

  // Only for assets too large for the device's shared memory: two blocks a multiprocessor, but at most 1 GiB if that is
  // enough for one.
  Status allocate_scratch(std::size_t instances) {
    constexpr std::size_t kBytesMax = std::size_t{1} << 30;
    DeviceLimits limits{};
    const Status status = find_limits(limits);
    const std::size_t block = crowd_block_bytes(table(), true, false, true);
    if (status != SC_OK || block <= limits.shared_bytes_max) {
      return status;
    }
    const std::size_t useful = std::min(2 * limits.multiprocessors, (instances + kLanes - 1) / kLanes);
    return scratch.reserve(block * std::clamp<std::size_t>(kBytesMax / block, 1, std::max<std::size_t>(useful, 1)));
  }

  Status allocate_on_device(std::size_t instances, std::size_t pair_capacity) {
    return first_failure(
        [&] { return check_device(); }, [&] { return device_table.assign(host_table.data(), host_table.size()); },
        [&] { return spheres.reserve(instances * header_of(table()).sphere_count); },
        [&] { return counts.reserve(instances); }, [&] { return starts.reserve(instances); },
        [&] { return pair_count.reserve(1); }, [&] { return pairs.reserve(pair_capacity); },
        [&] { return allocate_scratch(instances); }, [&] { return status_of(cudaEventCreate(&begin)); },
        [&] { return status_of(cudaEventCreate(&end)); });
  }

  std::uint64_t* table() { return reinterpret_cast<std::uint64_t*>(host_table.data()); }

  std::vector<Float4> host_table;  // two words each
  Array<Float4> device_table;
  Array<std::uint64_t> starts, pair_count;
  Array<float> matrices;
  Array<Sphere> spheres;
  Array<std::uint32_t> counts;
  Array<CrowdPair> pairs;
  Array<unsigned char> scratch;
  cudaEvent_t begin = nullptr, end = nullptr;
  // Copies of the device's, of the size that open() was given.
  std::vector<std::uint64_t> host_starts;
  std::vector<std::uint32_t> host_counts;
  std::vector<CrowdPair> host_pairs;
};

void HostCrowd::close() noexcept {
  delete memory_;
  memory_ = nullptr;
}

Status HostCrowd::open(const Asset& asset, Radius radius, const std::uint64_t* ignored_pairs, std::size_t instances,
                       std::size_t pair_capacity) noexcept {
  close();
  if (instances == 0 || instances > 0x7FFFFFFF || pair_capacity == 0) {
    return refuse(SC_BAD_VALUE, pair_capacity == 0 ? SC_FIELD_PAIRS : SC_FIELD_INSTANCES);
  }
  Status status = done();
  try {
    memory_ = new Memory;
    memory_->host_table.resize(crowd_table_words(asset) / 2);
    status = prepare_crowd(asset, radius, ignored_pairs, memory_->table(), 2 * memory_->host_table.size());
    memory_->host_starts.resize(instances);
    memory_->host_counts.resize(instances);
    memory_->host_pairs.resize(pair_capacity);
  } catch (const std::exception&) {
    status = refuse(SC_NO_MEMORY, SC_FIELD_NONE);
  }
  if (status == SC_OK) {
    status = header_of(memory_->table()).bone_count == 0 ? refuse(SC_NOT_IN_ASSET, SC_FIELD_BONES)
                                                         : memory_->allocate_on_device(instances, pair_capacity);
  }
  if (status != SC_OK) {
    close();
  }
  return status;
}

Status HostCrowd::run() noexcept {
  pair_count = 0;
  if (!is_open()) {
    return refuse(SC_NOT_OPEN, SC_FIELD_NONE);
  }
  Memory& m = *memory_;
  if (instance_count == 0) {
    return done();
  }
  if (instance_count > m.host_counts.size()) {
    return refuse(SC_BAD_VALUE, SC_FIELD_INSTANCES);
  }
  if (pose.bones == nullptr) {
    return refuse(SC_NULL, SC_FIELD_BONES);
  }
  CrowdGroup group;
  group.table = m.table();
  group.device_table = reinterpret_cast<const std::uint64_t*>(m.device_table.data());
  group.instance_count = instance_count;
  group.pose = pose;
  group.instance_stride = instance_stride;
  group.refitted = spheres == nullptr ? nullptr : m.spheres.data();
  group.counts = m.counts.data();
  group.starts = m.starts.data();
  group.pairs = m.pairs.data();
  group.pair_capacity = m.pairs.size();
  group.pair_count = m.pair_count.data();
  group.scratch = m.scratch.data();
  group.scratch_bytes = m.scratch.size();
  GroupView checked;  // before anything is computed from the strides
  if (const Status refused = view_group(group, checked); refused != SC_OK) {
    return refused;
  }
  const TableHeader& header = header_of(m.table());
  const std::size_t floats = (instance_count - 1) * checked.instance_floats +
                             ((header.bone_count - 1) * bone_stride(pose) + size_of(pose.bone_layout)) / sizeof(float);
  std::uint64_t found = 0;
  const Status status = first_failure(
      [&] { return m.matrices.assign(pose.bones, floats); },
      [&] {
        group.pose.bones = m.matrices.data();
        return status_of(cudaEventRecord(m.begin));
      },
      [&] { return enqueue_crowds(&group, 1, nullptr); }, [&] { return status_of(cudaEventRecord(m.end)); },
      [&] { return status_of(cudaEventSynchronize(m.end)); },
      [&] { return status_of(cudaEventElapsedTime(&device_milliseconds, m.begin, m.end)); },
      [&] { return m.counts.get(m.host_counts.data(), instance_count); },
      [&] { return m.starts.get(m.host_starts.data(), instance_count); }, [&] { return m.pair_count.get(&found, 1); },
      [&] { return m.spheres.get(spheres, instance_count * header.sphere_count); });
  if (status != SC_OK) {
    return status;
  }
  pair_count = static_cast<std::size_t>(found);
  if (counts != nullptr) {
    std::copy_n(m.host_counts.begin(), instance_count, counts);
  }
  if (pairs == nullptr) {
    return done();
  }
  if (pair_count > m.pairs.size()) {
    return refuse(SC_OVERFLOW, SC_FIELD_PAIRS);
  }
  const Status copied = m.pairs.get(m.host_pairs.data(), pair_count);
  CrowdPair* to = pairs;
  for (std::size_t i = 0; i < instance_count && copied == SC_OK; ++i) {
    to = std::copy_n(m.host_pairs.begin() + static_cast<std::ptrdiff_t>(m.host_starts[i]), m.host_counts[i], to);
  }
  return copied;
}

}  // namespace spherechain::cuda
