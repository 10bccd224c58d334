// SPDX-License-Identifier: MIT
// enqueue_crowds() as one call, from the program's own memory: emulated_runs.cpp runs the kernel's steps on the CPU,
// device_runs.cpp the kernel on a device. The same tests are linked with each.
#pragma once

#include <cstdint>
#include <vector>

#include "crowd_launch.h"

namespace spherechain::test {

struct GroupInput {
  std::vector<std::uint64_t> table;
  std::size_t instance_count = 0;
  std::vector<Sphere> spheres;
  std::vector<float> matrices;  // or these; from matrices[offset] on
  Pose pose;                    // without bones
  std::size_t offset = 0, instance_stride = 0;
  bool wants_bits = true, wants_spheres = true;
  std::size_t pair_capacity = 0;  // 0: no list
  std::size_t scratch_bytes = 0;  // a multiple of 16
};

// Zeros where there is no table.
inline cuda::TableHeader header_of(const GroupInput& in) {
  return in.table.empty() ? cuda::TableHeader{} : cuda::header_of(in.table.data());
}

// Inputs alone, where they lie for who runs it.
inline cuda::CrowdGroup inputs_of(const GroupInput& in, const std::uint64_t* device_table, const Sphere* spheres,
                                  const float* matrices) {
  cuda::CrowdGroup group;
  group.table = in.table.empty() ? nullptr : in.table.data();
  group.device_table = in.table.empty() ? nullptr : device_table;
  group.instance_count = in.instance_count;
  group.spheres = in.spheres.empty() ? nullptr : spheres;
  group.pose = in.pose;
  group.pose.bones = in.matrices.empty() ? nullptr : matrices + in.offset;
  group.instance_stride = in.instance_stride;
  return group;
}

struct GroupOutput {
  std::vector<Sphere> refitted;
  std::vector<std::uint32_t> counts;
  std::vector<std::uint64_t> bits, starts;
  std::vector<CrowdPair> pairs;  // as many as the capacity, dirty where nothing was written
  std::uint64_t pair_count = 0;
};

inline constexpr std::uint8_t kDirty = 0xDD;  // what outputs hold before

struct CrowdRun {
  Status status;
  std::vector<GroupOutput> groups;
};
CrowdRun run_crowd(const std::vector<GroupInput>& groups);

// "emulated on the CPU", or the device's name. Prints why and returns false where nothing can be run.
bool can_run(const char*& where);

}  // namespace spherechain::test
