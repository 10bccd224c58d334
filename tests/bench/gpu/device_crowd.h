// SPDX-License-Identifier: MIT
// A crowd whose inputs and outputs are on the device: instance i is in pose i of the file, again and again.
#pragma once

#include <memory>

#include "device.h"
#include "posed_asset.h"
#include "spherechain/cuda.h"

namespace spherechain::bench {

// The CPU's results for each pose.
struct Reference {
  std::vector<Sphere> spheres;        // pose after pose
  std::vector<std::uint32_t> counts;  // a pose each
  std::vector<std::uint64_t> bits;    // bit words a pose
};
Reference reference_of(const PosedAsset& posed, Radius radius);
// Fills in the pairs of the reference's spheres.
void detect(const PosedAsset& posed, Radius radius, Reference& reference);

class DeviceCrowd {
 public:
  DeviceCrowd(const PosedAsset& posed, const Reference& reference, Radius radius, std::size_t instances);

  enum Output : unsigned { kCounts = 1, kBits = 2, kList = 4, kSpheres = 8 };
  // One launch on the default stream: of the first `instances`, from bones or from spheres. Two sets of inputs take
  // turns, so that none is still in the device's cache from the launch before.
  void enqueue(bool from_bones, unsigned outputs, std::size_t instances);

  // Launches all instances once and compares what comes out with the reference, bit for bit. Prints what differs.
  bool runs_right(bool from_bones, unsigned outputs);

  // Memory of a block, and how many such are given to assets too large for shared memory: two a multiprocessor.
  std::size_t block_bytes() const { return cuda::crowd_block_bytes(table_.data(), !matrices_.empty(), true, true); }
  std::size_t scratch_blocks() const { return scratch_.size() / block_bytes(); }
  const Sphere* spheres() const { return spheres_[0].data(); }
  std::size_t bytes_moved(bool from_bones, unsigned outputs) const;  // an instance: inputs read once, outputs written

 private:
  struct Wrong {
    std::size_t count = 0;
    void add(std::size_t instance, const char* what);  // prints the first few
  };
  std::vector<std::uint64_t> listed_bits(Wrong& wrong) const;

  const PosedAsset& posed_;
  const Reference& reference_;
  std::size_t instances_, launches_ = 0;
  std::vector<std::uint64_t> table_;
  std::unique_ptr<DeviceArray<std::uint64_t>> device_table_;
  std::vector<DeviceArray<float>> matrices_;
  std::vector<DeviceArray<Sphere>> spheres_;
  DeviceArray<Sphere> refitted_;
  DeviceArray<std::uint32_t> counts_;
  DeviceArray<std::uint64_t> bits_, starts_, pair_count_;
  DeviceArray<CrowdPair> pairs_;
  DeviceArray<unsigned char> scratch_;
};

}  // namespace spherechain::bench
