// SPDX-License-Identifier: MIT
// Refit from bones of as many instances as a register has lanes, one a lane.
#pragma once

#include <cstddef>

#include "bone_refit.h"

namespace spherechain {

struct LaneRefit {
  BoneRefitInputs inputs;  // of the first instance
  std::size_t bone_count = 0, morph_count = 0;
  std::size_t instance_stride = 0;  // floats from one instance's matrices to the next's
  std::size_t count = 0;            // instances, at most the target's lanes
  std::size_t next_count = 0;  // instances that come after them, in the next call: fetched into the cache meanwhile
  // Scratch, aligned to 64 bytes: kMatrixFloats * kMostLanes floats a bone, kMostLanes a morph target.
  float* matrices = nullptr;
  float* morph_weights = nullptr;
  float* lanes = nullptr;  // out: as LaneBatch has them
};

inline constexpr std::size_t kMatrixFloats = 12;

// The spheres that refit_from_bones gives each instance.
void refit_lanes(Target resolved, const LaneRefit& batch);

}  // namespace spherechain
