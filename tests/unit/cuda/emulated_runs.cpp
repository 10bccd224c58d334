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

template <typename T>
std::vector<Chunk> aligned(const std::vector<T>& from) {
  std::vector<Chunk> out((from.size() * sizeof(T) + sizeof(Chunk) - 1) / sizeof(Chunk));
  if (!from.empty()) std::memcpy(static_cast<void*>(out.data()), from.data(), from.size() * sizeof(T));
  return out;
}

}  // namespace

CrowdRun run_crowd(const std::vector<GroupInput>& groups) {
  CrowdRun out{{SC_OK, SC_FIELD_NONE}, std::vector<GroupOutput>(groups.size())};
  std::mt19937 random(static_cast<unsigned>(groups.size()));
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const GroupInput& in = groups[g];
    GroupOutput& to = out.groups[g];
    const std::vector<Chunk> table = aligned(in.table), spheres = aligned(in.spheres), matrices = aligned(in.matrices);
    cuda::CrowdGroup group =
        inputs_of(in, reinterpret_cast<const std::uint64_t*>(table.data()),
                  reinterpret_cast<const Sphere*>(spheres.data()), reinterpret_cast<const float*>(matrices.data()));
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
    out.status = cuda::view_groups(&group, 1, all);
    if (out.status == SC_OK) out.status = cuda::plan_launches(all, kSharedBytes, plan);
    if (out.status != SC_OK) return out;
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
