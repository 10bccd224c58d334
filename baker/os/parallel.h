// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

namespace spherechain::baker {

// Number of processors that this process may run on (taskset, Slurm), at least 1.
std::size_t processor_count();
// A good number of threads: one a processor, at most 16. It may change while the program runs.
std::size_t thread_count();

// Calls work(thread, i) for all i below `count`, on up to `threads` threads; `thread` is below that number, so callers
// can keep one state a thread. No two calls with the same `thread` run at once. One thread takes runs of neighbours. An
// exception that `work` throws is thrown here, when all threads have ended.
void run_parallel(std::size_t threads, std::size_t count,
                  const std::function<void(std::size_t thread, std::size_t i)>& work);

}  // namespace spherechain::baker
