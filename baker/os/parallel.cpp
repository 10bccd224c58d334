// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/os/parallel.h"

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace spherechain::baker {

std::size_t processor_count() {
  cpu_set_t set;  // too small for a machine of more than 1,024 processors
  const bool is_known = ::sched_getaffinity(0, sizeof set, &set) == 0;
  return std::max<std::size_t>(
      1, is_known ? static_cast<std::size_t>(CPU_COUNT(&set)) : std::thread::hardware_concurrency());
}

std::size_t thread_count() { return std::min<std::size_t>(processor_count(), 16); }

// The threads end with the call: a process that is forked later has no half of a pool of threads.
void run_parallel(std::size_t threads_max, std::size_t count,
                  const std::function<void(std::size_t thread, std::size_t i)>& work) {
  const std::size_t threads = std::min(threads_max, count);
  if (threads == 0) return;
  constexpr std::size_t kRunsPerThread = 8;  // so that a thread with quick runs takes more of them
  const std::size_t run = (count + kRunsPerThread * threads - 1) / (kRunsPerThread * threads);
  std::atomic<std::size_t> next = 0;
  std::vector<std::exception_ptr> failures(threads);
  const auto work_through = [&](std::size_t thread) {
    try {
      for (std::size_t first = next.fetch_add(run); first < count; first = next.fetch_add(run)) {
        for (std::size_t i = first; i < std::min(first + run, count); ++i) work(thread, i);
      }
    } catch (...) {
      failures[thread] = std::current_exception();
      next = count;
    }
  };
  {
    std::vector<std::jthread> others;
    for (std::size_t thread = 1; thread < threads; ++thread) others.emplace_back(work_through, thread);
    work_through(0);
  }
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

}  // namespace spherechain::baker
