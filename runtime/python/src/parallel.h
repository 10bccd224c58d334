// SPDX-License-Identifier: MIT
// Poses of a batch by several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

#include "signals.h"

namespace spherechain::python {

// Calls make_worker() once in each thread, and the worker that it returns with each index below `count`, in any order.
// `threads` 0: one for each core. The first exception, a signal's among them, is thrown again when all have stopped.
template <typename MakeWorker>
void for_each_pose(std::size_t count, std::size_t threads, const MakeWorker& make_worker) {
  if (threads == 0) {
    threads = std::max(1U, std::thread::hardware_concurrency());
  }
  threads = std::min(threads, count);
  std::atomic<std::size_t> next{0};
  std::atomic_flag has_failed = ATOMIC_FLAG_INIT;
  std::exception_ptr failure;
  const auto run = [&](auto&& before_each) {
    try {
      auto worker = make_worker();
      for (std::size_t i = next++; i < count; i = next++) {
        before_each();
        worker(i);
      }
    } catch (...) {
      next = count;
      if (!has_failed.test_and_set()) {
        failure = std::current_exception();
      }
    }
  };
  std::vector<std::thread> others;
  others.reserve(threads);
  for (std::size_t i = 1; i < threads; ++i) {
    try {
      others.emplace_back([&] { run([] {}); });
    } catch (const std::system_error&) {
      break;  // the system has no more threads: those there are do the work
    }
  }
  if (count > 0) {
    run([signals = SignalCheck()]() mutable { signals.run(); });
  }
  for (std::thread& other : others) {
    other.join();
  }
  if (failure) {
    std::rethrow_exception(failure);
  }
}

}  // namespace spherechain::python
