// SPDX-License-Identifier: MIT
// Upper limits of the device, measured; and the nearest neighbour's way of finding pairs.
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/types.h"

namespace spherechain::bench {

// Enqueues multiply-adds on all multiprocessors, in independent chains. Returns how many; `sink` is a float.
double enqueue_multiply_adds(int multiprocessors, float* sink);

// cuRobo's mapping of self-collision, written anew: a block a character, 512 threads, its spheres in shared memory, a
// list of pairs of 16-bit numbers; out comes the deepest pair alone.
struct Deepest {
  float depth;  // 0 where nothing touches
  std::int16_t a, b;
};
struct IndexPair {
  std::int16_t a, b;
};
void enqueue_block_a_character(const Sphere* spheres, std::size_t sphere_count, std::size_t instance_count,
                               const IndexPair* pairs, std::size_t pair_count, Deepest* out);

}  // namespace spherechain::bench
