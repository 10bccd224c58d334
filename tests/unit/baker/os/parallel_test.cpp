// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/os/parallel.h"

#include <doctest/doctest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

using namespace spherechain::baker;

TEST_CASE("work in parallel is done once for each index, and no two threads share a number") {
  constexpr std::size_t kThreads = 4;
  for (const std::size_t count : {0, 1, 3, 1000}) {
    std::vector<std::atomic<int>> done(count), busy(kThreads);
    std::atomic<int> shared = 0;
    run_parallel(kThreads, count, [&](std::size_t thread, std::size_t i) {
      shared += busy[thread]++ == 0 ? 0 : 1;
      ++done[i];
      std::this_thread::sleep_for(std::chrono::microseconds(50));  // so that calls overlap
      --busy[thread];
    });
    CHECK(shared == 0);
    for (const std::atomic<int>& times : done) CHECK(times == 1);
  }
}

TEST_CASE("what work in parallel throws is thrown when all threads have ended") {
  const auto fail = [](std::size_t, std::size_t i) {
    if (i == 700) throw std::runtime_error("700");
  };
  CHECK_THROWS_WITH_AS(run_parallel(3, 1000, fail), "700", std::runtime_error);
}
