// SPDX-License-Identifier: MIT
// The inner loop of SkinJob.
#pragma once

#include <cstddef>
#include <cstdint>

#include "skin.h"
#include "spherechain/simd.h"

namespace spherechain {

// Where the slots of the leaves are in the source.
struct SurfacePlaces {
  const Leaf* leaves;
  std::size_t leaf_count;
  const std::uint32_t* leaf_vertices;
  const std::uint32_t* source_vertices;
};

// `stride` in floats.
void skin_surface(const SkinInputs& inputs, const SurfacePlaces& places, Target resolved, float* positions,
                  std::size_t stride);

}  // namespace spherechain
