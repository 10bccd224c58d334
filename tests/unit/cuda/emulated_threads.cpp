// SPDX-License-Identifier: MIT
// The kernels' blocks by as many threads as they have, two blocks at the same time, with barriers where the kernel has
// them: the thread sanitizer tells of two threads, or two blocks, that touch the same memory with nothing between.
#include <pthread.h>

#include <cstring>
#include <functional>
#include <thread>
#include <utility>
#include <vector>

#include "crowd_body.h"
#include "emulated_blocks.h"

namespace spherechain::test {
namespace {

constexpr std::uint32_t kThreads = 64, kBlocksAtOnce = 2;

// The standard library's barriers spin before they sleep: far too long where 128 threads share two cores.
class Barrier {
 public:
  explicit Barrier(unsigned threads) { ::pthread_barrier_init(&barrier_, nullptr, threads); }
  ~Barrier() { ::pthread_barrier_destroy(&barrier_); }
  Barrier(const Barrier&) = delete;
  Barrier& operator=(const Barrier&) = delete;
  void arrive_and_wait() { ::pthread_barrier_wait(&barrier_); }

 private:
  pthread_barrier_t barrier_;
};

struct Barriers {
  Barrier* of_block;
  Barrier* of_warp;

  void block() const { of_block->arrive_and_wait(); }
  void warp() const { of_warp->arrive_and_wait(); }
};

struct Team {
  Barrier block{kThreads};
  Barrier warps[kThreads / cuda::kLanes]{Barrier{cuda::kLanes}, Barrier{cuda::kLanes}};
};

// Started once: the thread sanitizer takes longer to start and end a thread than most blocks take to run.
class Threads {
 public:
  Threads() {
    for (std::uint32_t i = 0; i < kBlocksAtOnce * kThreads; ++i) {
      threads_.emplace_back([this, i] {
        for (begin_.arrive_and_wait(); job_; begin_.arrive_and_wait()) {
          job_(i);
          end_.arrive_and_wait();
        }
      });
    }
  }
  ~Threads() {
    job_ = nullptr;
    begin_.arrive_and_wait();
  }
  Threads(const Threads&) = delete;
  Threads& operator=(const Threads&) = delete;

  void run(std::function<void(std::uint32_t)> job) {
    job_ = std::move(job);
    begin_.arrive_and_wait();
    end_.arrive_and_wait();
  }

 private:
  std::function<void(std::uint32_t)> job_;  // of a thread's number
  Barrier begin_{kBlocksAtOnce * kThreads + 1}, end_{kBlocksAtOnce * kThreads + 1};
  std::vector<std::jthread> threads_;  // the last member: they end before what they use
};

// `run`(which team, how the thread runs the steps of its block).
template <typename Run>
void run_teams(const Run& run) {
  static Threads threads;
  Team teams[kBlocksAtOnce];
  threads.run([&](std::uint32_t i) {
    const std::uint32_t which = i / kThreads, thread = i % kThreads;
    const Barriers barriers{&teams[which].block, &teams[which].warps[thread / cuda::kLanes]};
    run(which, [&](std::uint32_t block) { return cuda::RunThread<Barriers>{{thread, kThreads, block}, barriers}; });
  });
}

}  // namespace

void run_in_shared(const cuda::GroupView& view, std::mt19937&) {
  const std::uint32_t blocks = cuda::blocks_of(view);
  const std::size_t size = view.layout.size / sizeof(cuda::Float4);
  std::vector<std::vector<cuda::Float4>> memories(blocks, std::vector<cuda::Float4>(size));
  for (std::vector<cuda::Float4>& memory : memories) std::memset(memory.data(), kDirty, view.layout.size);
  run_teams([&](std::uint32_t which, const auto& run_of) {
    for (std::uint32_t block = which; block < blocks; block += kBlocksAtOnce) {
      cuda::run_block(view, cuda::Shared(memories[block].data(), view.layout), run_of(block));
    }
  });
}

void run_in_scratch(const cuda::GroupView& view, std::mt19937&) {
  run_teams([&](std::uint32_t which, const auto& run_of) {
    for (std::uint32_t first = which; first < view.scratch_blocks; first += kBlocksAtOnce) {
      cuda::run_blocks_in_scratch(view, first, run_of);
    }
  });
}

}  // namespace spherechain::test
