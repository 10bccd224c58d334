// SPDX-License-Identifier: MIT
// The pairs of as many instances as a register has lanes, one a lane.
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/asset.h"
#include "spherechain/crowd.h"
#include "spherechain/simd.h"
#include "spherechain/types.h"

namespace spherechain {

inline constexpr std::size_t kMostLanes = 16;
// A sphere's registers: x, y, z, radius; and seen from the instance's first sphere x, y, z and -power, as
// SphereColumns.
inline constexpr std::size_t kLaneFigures = 8;
// Up to this many pairs of an instance are listed as they are found.
inline constexpr std::size_t kMostListed = 64;

// Instances [0, count), count at most the target's lanes.
struct LaneBatch {
  const Sphere* spheres = nullptr;  // null: the first four of a sphere's `lanes` have them already
  std::size_t stride = 0, count = 0, sphere_count = 0;
  const float* padding = nullptr;         // may be null
  const std::uint64_t* wanted = nullptr;  // a bit a pair, in the order of Asset::ignored(): to be tested; no near pair
  Span<const NearPair> near;
  const std::uint64_t* near_wanted = nullptr;  // a bit each
  float* lanes = nullptr;                      // scratch, aligned to 64 bytes: kLaneFigures registers a sphere
  // Out. Each instance's table of bits, bit_words each; the words are 0 before.
  std::uint64_t* bits = nullptr;
  std::size_t bit_words = 0;
  std::uint32_t pair_counts[kMostLanes] = {};
  std::uint32_t listed[kMostLanes][kMostListed];  // each instance's pairs as 2^16 a + b, in some order, if not more
};

void test_lanes(Target resolved, LaneBatch& batch);

// The first `count` pairs of an instance, into the list in order, as many as it holds.
void list_in_order(Target resolved, const std::uint32_t (&listed)[kMostListed], std::size_t count,
                   std::uint32_t instance, Span<CrowdPair> list);

}  // namespace spherechain
