// SPDX-License-Identifier: MIT
// The paper's kernels on a device, one character at a time, and what they take. For measuring: throws
// std::runtime_error, which names the CUDA call that failed.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "paper_threads.h"

namespace spherechain::cuda_paper {

enum class Kernel {
  kEmpty,     // does nothing: what a launch takes
  kM2Sphere,  // a thread a sphere
  kM1Chain,   // a thread a chain
  kM1Sphere,  // a thread a sphere of a chain
};

// Microseconds.
struct Times {
  double kernel;  // the kernel alone, by CUDA events
  double launch;  // by the host's clock: spheres on the device already; launch, wait, the count back
  double frame;   // by the host's clock: the spheres to the device, launch, wait, the count and the pairs back
};

struct Device {
  std::string chip, driver, runtime;  // the last two: versions of CUDA
};
Device device();

class Runner {
 public:
  // Allocates memory for `pair_capacity` pairs.
  Runner(const Tables& tables, std::uint32_t pair_capacity);
  ~Runner();
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  // As many spheres as the asset has. Sorted by chain, then pair. Throws where there are more than there is room for.
  std::vector<ChainPair> pairs(Kernel kernel, const Sphere* spheres);

  // A launch for each.
  Times time(Kernel kernel, const Sphere* spheres);

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

}  // namespace spherechain::cuda_paper
