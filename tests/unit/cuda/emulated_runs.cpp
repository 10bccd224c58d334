// SPDX-License-Identifier: MIT
#include <cstring>

#include "crowd_runs.h"
#include "emulated_blocks.h"

namespace spherechain::test {
namespace {

constexpr std::size_t kSharedBytes = 227 * 1024;  // Hopper's

template <typename T>
T* take(std::vector<T>& to, std::size_t count) {
  if (count == 0) return nullptr;
  to.resize(count);
  std::memset(static_cast<void*>(to.data()), kDirty, count * sizeof(T));
  return to.data();
}

struct alignas(16) Chunk {
  std::uint64_t words[2];
};

}  // namespace

CrowdRun run_crowd(const std::vector<GroupInput>& groups) {
  CrowdRun out{Status::kOk, std::vector<GroupOutput>(groups.size())};
  std::mt19937 random(static_cast<unsigned>(groups.size()));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const GroupInput& in = groups[g];
    GroupOutput& to = out.groups[g];
    std::vector<Chunk> tables((in.words.size() + 1) / 2);
    if (!in.words.empty()) std::memcpy(tables.data(), in.words.data(), in.words.size() * sizeof in.words[0]);
    std::vector<Chunk> aligned((in.matrices.size() + 3) / 4);
    if (!in.matrices.empty()) std::memcpy(aligned.data(), in.matrices.data(), in.matrices.size() * sizeof(float));
    std::vector<Chunk> spheres(in.spheres.size());
    if (!in.spheres.empty()) std::memcpy(spheres.data(), in.spheres.data(), in.spheres.size() * sizeof(Sphere));

    cuda::CrowdGroup group;
    group.tables = in.tables;
    group.device_tables = in.words.empty() ? nullptr : tables[0].words;
    group.instance_count = in.instance_count;
    group.spheres = in.spheres.empty() ? nullptr : reinterpret_cast<const Sphere*>(spheres.data());
    group.stride = in.stride;
    if (!in.matrices.empty()) {
      group.bones = {reinterpret_cast<const float*>(aligned.data()) + in.offset, in.bone_count, in.layout,
                     in.bone_stride};
    }
    group.instance_stride = in.instance_stride;
    const std::size_t count = in.instance_count;
    const cuda::TableHeader header = header_of(in);
    group.refitted = take(to.refitted, in.wants_spheres && !in.matrices.empty() ? header.sphere_count * count : 0);
    group.counts = take(to.counts, count);
    group.bits = take(to.bits, in.wants_bits ? header.bit_words * count : 0);
    group.starts = take(to.starts, count);
    group.pairs = take(to.pairs, in.pair_capacity);
    group.pair_capacity = in.pair_capacity;
    group.pair_count = &to.pair_count;

    std::vector<Chunk> scratch(in.scratch_bytes / sizeof(Chunk));
    if (in.scratch_bytes > 0) std::memset(scratch.data(), kDirty, in.scratch_bytes);
    group.scratch = in.scratch_bytes > 0 ? scratch.data() : nullptr;
    group.scratch_bytes = in.scratch_bytes;

    cuda::Launch all;
    cuda::LaunchPlan plan;
    out.status = cuda::view_groups({&group, 1}, all);
    if (out.status == Status::kOk) out.status = cuda::plan_launches(all, kSharedBytes, plan);
    if (out.status != Status::kOk) return out;
    for (std::uint32_t k = 0; k < cuda::kKernels; ++k)
      run_kernel(static_cast<cuda::Kernel>(k), plan.launches[k], random);
  }
  return out;
}

bool can_run(const char*& where) {
  where = "emulated on the CPU";
  return true;
}

}  // namespace spherechain::test
