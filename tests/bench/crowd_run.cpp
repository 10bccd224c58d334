// SPDX-License-Identifier: GPL-3.0-or-later
#include "crowd_run.h"

#include <atomic>
#include <stdexcept>
#include <thread>

#include "runtime/src/pairs/detect_job.h"

namespace spherechain::bench {
namespace {

constexpr std::size_t kTasksAThread = 16;   // so that none waits long for the last
constexpr std::size_t kPairsInstance = 64;  // room, over the crowd

}  // namespace

CrowdRun::CrowdRun(const PosedCharacter& character, std::size_t instance_count, std::size_t thread_count)
    : thread_count_(thread_count), counts_(instance_count), pairs_(kPairsInstance * instance_count) {
  for (std::size_t i = 0; i < instance_count; ++i) {
    const auto& pose = character.matrices[i % character.matrices.size()];
    matrices_.insert(matrices_.end(), pose.begin(), pose.end());
  }
  const std::size_t task_count = thread_count == 1 ? 1 : kTasksAThread * thread_count;
  words_.resize(sc_crowd_scratch_words(&character.asset, task_count));
  job_.asset = &character.asset;
  job_.instance_count = instance_count;
  job_.pose = character.pose(0);
  job_.pose.bones = matrices_.data();
  job_.instance_stride = matrices_.size() / instance_count * sizeof(float);
  job_.scratch = words_.data();
  job_.scratch_words = words_.size();
  job_.task_count = task_count;
  job_.counts = counts_.data();
  job_.count_capacity = counts_.size();
  job_.pairs = pairs_.data();
  job_.pair_capacity = pairs_.size();
  if (thread_count > 1) {
    job_.parallel_for = &CrowdRun::on_threads;
    job_.user = this;
  }
}

void CrowdRun::on_threads(void* self_pointer, std::size_t count, void (*task)(void*, std::size_t), void* data) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      task(data, i);
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t t = 1; t < static_cast<CrowdRun*>(self_pointer)->thread_count_; ++t) {
    threads.emplace_back(work);
  }
  work();
  for (std::thread& thread : threads) {
    thread.join();
  }
}

void CrowdRun::run() {
  if (job_.run() != SC_OK) {
    throw std::logic_error("the crowd did not run");
  }
}

bool CrowdRun::has_the_pairs_of(const PosedCharacter& character) const {
  std::vector<std::vector<Pair>> expected;
  std::vector<Pair> buffer(character.sphere_count() * character.sphere_count());
  for (const auto& spheres : character.spheres) {
    DetectJob job;
    job.asset = &character.asset;
    job.spheres = spheres.data();
    job.sphere_count = spheres.size();
    job.pairs = buffer.data();
    job.pair_capacity = buffer.size();
    if (job.run() != SC_OK) {
      return false;
    }
    expected.emplace_back(buffer.begin(), buffer.begin() + static_cast<std::ptrdiff_t>(job.pair_count));
  }
  std::size_t at = 0;
  for (std::uint32_t i = 0; i < job_.instance_count; ++i) {
    const std::vector<Pair>& own = expected[i % expected.size()];
    if (counts_[i] != own.size()) {
      return false;
    }
    for (const Pair& pair : own) {
      if (at == job_.pair_count || pairs_[at].instance != i || pairs_[at].pair != pair) {
        return false;
      }
      ++at;
    }
  }
  return at == job_.pair_count;
}

}  // namespace spherechain::bench
