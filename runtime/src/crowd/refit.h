// SPDX-License-Identifier: MIT
// Refit from bones of as many instances as a register has lanes, one a lane.
#pragma once

#include <cstddef>

#include "refit/inputs.h"

namespace spherechain {

struct LaneRefit {
  RefitInputs inputs;  // of the first instance
  std::size_t bone_count = 0;
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

// Of LaneRefit::products; 0 where there are no moments.
std::size_t product_floats(const MomentTables& moments);

}  // namespace spherechain
