// SPDX-License-Identifier: MIT
#include "emulated_blocks.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "crowd_body.h"

namespace spherechain::test {
namespace {

constexpr std::uint32_t kThreads = 96;  // not the device's number: nothing may depend on it

std::vector<std::uint32_t> shuffled(std::uint32_t count, std::mt19937& random) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0U);
  std::shuffle(order.begin(), order.end(), random);
  return order;
}

// A step's threads from a random one on, a random distance apart: an order that costs little beside the step itself.
struct RunStep {
  std::mt19937& random;
  std::uint32_t block;

  template <typename Step>
  void operator()(const Step& step) const {
    std::uniform_int_distribution<std::uint32_t> any(0, kThreads - 1);
    std::uint32_t thread = any(random), distance = any(random);
    while (std::gcd(distance, kThreads) != 1) ++distance;
    for (std::uint32_t i = 0; i < kThreads; ++i) {
      step(cuda::Place{thread, kThreads, block});
      thread = (thread + distance) % kThreads;
    }
  }
  template <typename... Steps>
  void for_instances(const cuda::GroupView& v, const cuda::Shared& shared, const Steps&... steps) const {
    for (std::uint32_t first = 0; first < cuda::kSphereInstances; first += kThreads / cuda::kLanes) {
      const auto run_for_warp = [&](const auto& step) {
        (*this)([&](const cuda::Place& at) {
          const std::uint32_t place = first + at.warp();
          if (place < cuda::instances_in(v, at)) step(cuda::WarpInstance(shared, at, place));
        });
      };
      (run_for_warp(steps), ...);
    }
  }
};

}  // namespace

void run_in_shared(const cuda::GroupView& view, std::mt19937& random) {
  const cuda::BlockLayout& layout = view.layout;
  for (const std::uint32_t block : shuffled(cuda::blocks_of(view), random)) {
    std::vector<cuda::Float4> memory(layout.size / sizeof(cuda::Float4));  // exactly, for sanitizers
    std::memset(memory.data(), kDirty, layout.size);
    cuda::run_block(view, cuda::Shared(memory.data(), layout), RunStep{random, block});
  }
}

void run_in_scratch(const cuda::GroupView& view, std::mt19937& random) {
  for (const std::uint32_t first : shuffled(view.scratch_blocks, random)) {
    cuda::run_blocks_in_scratch(view, first, [&](std::uint32_t block) { return RunStep{random, block}; });
  }
}

}  // namespace spherechain::test
