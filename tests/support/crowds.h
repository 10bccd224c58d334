// SPDX-License-Identifier: MIT
// The memory that a crowd job's caller owns.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "spherechain/crowd.h"

namespace spherechain::test {

// Buffers sized exactly and dirty, and a job that has them. The user says where its spheres or bones are.
struct CrowdBuffers {
  CrowdBuffers(const Asset& asset, std::size_t instance_count, std::size_t task_count);
  CrowdBuffers(const CrowdBuffers&) = delete;  // the job points into this

  std::vector<std::uint64_t> scratch;
  std::vector<std::uint32_t> counts;
  CrowdJob job;
};

// A parallel_for: tasks on as many threads as the std::size_t at `user` says, dealt out in turn, the last ones first.
void on_threads(void* user, std::size_t count, void (*task)(void*, std::size_t), void* data);

}  // namespace spherechain::test
