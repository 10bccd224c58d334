// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cstring>
#include <numeric>
#include <random>

#include "crowd_access.h"
#include "crowd_body.h"
#include "crowd_runs.h"

namespace spherechain::test {
namespace {

constexpr std::uint32_t kThreads = 96;            // not the device's number: nothing may depend on it
constexpr std::size_t kSharedBytes = 227 * 1024;  // Hopper's

std::vector<std::uint32_t> shuffled(std::uint32_t count, std::mt19937& random) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  std::shuffle(order.begin(), order.end(), random);
  return order;
}

// Blocks one after another, and within each step the threads, in any order: what needs a barrier and has none shows.
Status run_blocks(const cuda::GroupView& view, std::mt19937& random) {
  const cuda::SharedLayout layout = cuda::shared_layout(view);
  if (layout.size > kSharedBytes) return Status::kDeviceTooSmall;
  for (const std::uint32_t block : shuffled(cuda::blocks_of(view), random)) {
    std::vector<cuda::Float4> memory(layout.size / sizeof(cuda::Float4));  // exactly, for sanitizers
    std::memset(memory.data(), kDirty, layout.size);
    const cuda::Shared shared(memory.data(), layout);
    const auto run = [&](const auto& step) {
      for (const std::uint32_t thread : shuffled(kThreads, random)) step(cuda::Place{thread, kThreads, block});
    };
    if (view.matrices == nullptr) {
      cuda::run_block<false, false>(view, shared, run);
    } else if (view.morph_weights == nullptr) {
      cuda::run_block<true, false>(view, shared, run);
    } else {
      cuda::run_block<true, true>(view, shared, run);
    }
  }
  return Status::kOk;
}

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
    group.morph_weights = in.morph_weights.empty() ? nullptr : in.morph_weights.data();
    const std::size_t n = in.tables == nullptr ? 0 : in.tables->sphere_count(), count = in.instance_count;
    group.refitted = take(to.refitted, in.wants_spheres && !in.matrices.empty() ? n * count : 0);
    group.bounds = take(to.bounds, in.wants_spheres ? count : 0);
    group.counts = take(to.counts, count);
    group.bits = take(to.bits, in.wants_bits && in.tables != nullptr ? in.tables->bit_words() * count : 0);
    group.starts = take(to.starts, count);
    group.pairs = take(to.pairs, in.pair_capacity);
    group.pair_capacity = in.pair_capacity;
    group.pair_count = &to.pair_count;

    cuda::GroupView view{};
    out.status = cuda::view_group(group, view);
    if (out.status == Status::kOk && view.instance_count > 0) out.status = run_blocks(view, random);
    if (out.status != Status::kOk) return out;
  }
  return out;
}

bool can_run(const char*& where) {
  where = "emulated on the CPU";
  return true;
}

}  // namespace spherechain::test
