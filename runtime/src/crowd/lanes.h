// SPDX-License-Identifier: MIT
// Refit from bones and pairs of as many instances as a register has lanes, one a lane.
#pragma once

#include <cstddef>
#include <cstdint>

#include "runtime/src/asset/asset_view.h"
#include "runtime/src/refit/inputs.h"
#include "spherechain/types.h"

namespace spherechain {

inline constexpr std::size_t kMaxLanes = 16;
// A sphere's registers: x, y, z, radius; and seen from the instance's first sphere x, y, z and -power, as
// SphereColumns.
inline constexpr std::size_t kLaneFigures = 8;
// So many pairs of an instance are listed as they are found.
inline constexpr std::size_t kMaxListed = 64;

// Instances [0, count), count at most the target's lanes.
struct LaneBatch {
  const Sphere* spheres = nullptr;  // null: the first four of a sphere's `lanes` have them already
  std::size_t stride = 0, count = 0, sphere_count = 0;
  std::size_t bit_words = 0;  // of each table of bits
  // A bit a pair, in the order of sorted pairs: those to be tested, and those that `rest_pairs` has, in its order.
  const std::uint64_t *wanted = nullptr, *is_rest_pair = nullptr;
  Span<const RestPair> rest_pairs;
  float* lanes = nullptr;               // scratch, aligned to 64 bytes: kLaneFigures registers a sphere
  std::uint16_t* candidates = nullptr;  // scratch: candidate_places() of the spheres
  // Out. Each instance's table of bits, in the order of AssetView::ignored(), 0 before; or null.
  std::uint64_t* bits = nullptr;
  std::uint32_t pair_counts[kMaxLanes] = {};
  // Each instance's first pairs as 2^16 a + b, in order. The last place is for what is no pair.
  std::uint32_t listed[kMaxLanes][kMaxListed + 1];
};

// Two rows of the table of pairs, each up to a whole word's bits.
constexpr std::size_t candidate_row(std::size_t sphere_count) { return sphere_count + 64; }
constexpr std::size_t candidate_places(std::size_t sphere_count) { return 2 * candidate_row(sphere_count); }

void test_lanes(Target resolved, LaneBatch& batch);

struct LaneRefit {
  RefitInputs inputs;               // of the first instance
  std::size_t instance_stride = 0;  // floats from one instance's matrices to the next's
  std::size_t count = 0;            // instances, at most the target's lanes
  std::size_t next_count = 0;  // instances that come after them, in the next call: fetched into the cache meanwhile
  // Scratch, aligned to 64 bytes: kMatrixFloats * kMaxLanes floats a bone, product_floats() of the moments.
  float* matrices = nullptr;
  float* products = nullptr;
  float* lanes = nullptr;  // out: as LaneBatch has them
};

inline constexpr std::size_t kMatrixFloats = 12;

// The spheres that refit_from_moments() gives each instance.
void refit_lanes(Target resolved, const LaneRefit& batch);

// Size of LaneRefit::products in floats; 0 if the asset has no moments.
std::size_t product_floats(const MomentTables& moments);

}  // namespace spherechain
