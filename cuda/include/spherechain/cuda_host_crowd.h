// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/cuda_crowd.h"

namespace spherechain::cuda {

// A crowd whose bones and results are the CPU's: for tools, tests and a first try. Games keep both on the device and
// use CrowdJob. One thread at a time; it belongs to the device that was current in open().
class HostCrowd {
 public:
  HostCrowd() = default;
  HostCrowd(const HostCrowd&) = delete;
  HostCrowd& operator=(const HostCrowd&) = delete;
  ~HostCrowd() { close(); }

  // Allocates on the device what up to `instances` and `pair_capacity` pairs in all take, scratch for a large asset
  // too; drops what was open. What CrowdTables::build returns; kNotInAsset where the asset has no bones; kBadArgument
  // for no instances, more than 2^31 - 1, or no pairs; kNoDevice; kDeviceFailed, also where there is not as much
  // memory, here or there. Closed on failure.
  Status open(const Asset& asset, RadiusKind radius, const Filter* filter, std::size_t instances,
              std::size_t pair_capacity) noexcept;
  void close() noexcept;
  bool is_open() const noexcept { return instances_ > 0; }

  // In. Instance i's matrices begin i * instance_stride bytes after `bones.data`. Morph weights: as many an instance as
  // the asset has targets, or null.
  BoneMatrices bones;
  std::size_t instance_stride = 0;
  const float* morph_weights = nullptr;
  std::size_t instance_count = 0;  // at most those of open()

  // Out: as many as their types' jobs say, or null.
  Sphere* spheres = nullptr;
  std::uint32_t* counts = nullptr;
  CrowdPair* pairs = nullptr;     // sorted by instance, then pair; up to open()'s capacity
  std::size_t pair_count = 0;     // how many there are
  float device_milliseconds = 0;  // of the launch alone

  // Copies there, runs, copies back, waits. kOk; kOverflow where there are more pairs than the capacity (then `pairs`
  // has none); kNotOpen; kBadArgument for too many instances; and what CrowdJob::run returns.
  Status run() noexcept;

 private:
  struct Memory;
  Status allocate_here(const Asset& asset, std::size_t instances, std::size_t pair_capacity) noexcept;
  Status allocate_scratch(std::size_t instances) noexcept;

  Memory* memory_ = nullptr;
  CrowdTables tables_;
  std::size_t instances_ = 0, pair_capacity_ = 0;
};

}  // namespace spherechain::cuda
