// SPDX-License-Identifier: MIT
// Poses of a batch by several threads, without the GIL.
#pragma once

#include "python.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

namespace spherechain::python {

// Python runs the handlers of signals in its main thread alone; the module sets this when it is made.
inline unsigned long main_thread = 0;

// Ctrl-C during a batch. Call it often, in the thread that Python called: every 50 ms it lets Python handle pending
// signals, and throws what their handlers raise, as KeyboardInterrupt.
class SignalCheck {
 public:
  void operator()() {
    const Clock::time_point now = Clock::now();
    // A thread that asks for the GIL while Python exits is ended, in the midst of C++: only the main thread asks.
    if (now - last_ < std::chrono::milliseconds(50) || PyThread_get_thread_ident() != main_thread) {
      return;
    }
    last_ = now;
    const WithGil gil;
    if (PyErr_CheckSignals() != 0) {
      throw PythonError{};
    }
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

// Calls make_worker() once in each thread, and the worker that it returns with each index below `count`, in any order.
// `threads` 0: one for each core. The first exception, a signal's among them, is thrown again when all have stopped.
template <typename MakeWorker>
void for_each_pose(std::size_t count, std::size_t threads, const MakeWorker& make_worker) {
  const WithoutGil others_run;
  threads = std::min<std::size_t>(threads == 0 ? std::max(1U, std::thread::hardware_concurrency()) : threads, count);
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
    run(SignalCheck());
  }
  for (std::thread& other : others) {
    other.join();
  }
  if (failure) {
    std::rethrow_exception(failure);
  }
}

}  // namespace spherechain::python
