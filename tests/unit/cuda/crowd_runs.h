// SPDX-License-Identifier: MIT
// A CrowdJob as one call, from the program's own memory: emulated_runs.cpp runs the kernel's steps on the CPU,
// device_runs.cpp the kernel on a device. The same tests are linked with each.
#pragma once

#include <cstdint>
#include <vector>

#include "crowd_launch.h"

namespace spherechain::test {

struct GroupInput {
  const cuda::CrowdTables* tables = nullptr;
  std::vector<std::uint64_t> words;  // of the tables
  std::size_t instance_count = 0;
  std::vector<Sphere> spheres;
  std::size_t stride = 0;
  std::vector<float> matrices;  // or these; from matrices[offset] on
  std::size_t offset = 0, bone_count = 0, bone_stride = 48, instance_stride = 0;
  MatrixLayout layout = MatrixLayout::kRowMajor3x4;
  bool wants_bits = true, wants_spheres = true;
  std::size_t pair_capacity = 0;  // 0: no list
  std::size_t scratch_bytes = 0;  // a multiple of 16
};

// Zeros if the tables are not built.
inline cuda::TableHeader header_of(const GroupInput& in) {
  return in.tables == nullptr || in.tables->words.size == 0 ? cuda::TableHeader{} : cuda::header_of(*in.tables);
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
