// SPDX-License-Identifier: MIT
#include "crowds.h"

#include <thread>

namespace spherechain::test {

CrowdBuffers::CrowdBuffers(const Asset& asset, std::size_t instance_count, std::size_t task_count)
    : scratch(sc_crowd_scratch_words(&asset, task_count), 0xDDDDDDDDDDDDDDDDU), counts(instance_count, 7) {
  job.asset = &asset;
  job.instance_count = instance_count;
  job.scratch = scratch.data();
  job.scratch_words = scratch.size();
  job.task_count = task_count;
  job.counts = counts.data();
  job.count_capacity = counts.size();
}

void on_threads(void* user, std::size_t count, void (*task)(void*, std::size_t), void* data) {
  const std::size_t threads = *static_cast<std::size_t*>(user);
#if defined(__EMSCRIPTEN__) && !defined(__EMSCRIPTEN_PTHREADS__)  // no threads: the same tasks, one after the other
  for (std::size_t i = count; i-- > 0;) task(data, i);
  (void)threads;
#else
  std::vector<std::thread> running;
  for (std::size_t t = 0; t < threads; ++t) {
    running.emplace_back([=] {
      for (std::size_t i = t; i < count; i += threads) task(data, count - 1 - i);
    });
  }
  for (std::thread& thread : running) thread.join();
#endif
}

}  // namespace spherechain::test
