// SPDX-License-Identifier: MIT
// What skinning and bounding clusters read, as bare arrays: kernels are compiled once a target and may use no inline
// function of the headers.
#pragma once

#include <cstddef>
#include <cstdint>

#include "pose/pose.h"
#include "skin/skin_table.h"

namespace spherechain {

inline constexpr std::size_t kMaxClusterSlots = (kMaxClusterVertices + kSlotLanes - 1) / kSlotLanes * kSlotLanes;

struct SkinInputs {
  const float* slot_positions;
  const float* slot_weights;
  const SlotMorph* slot_morphs;
  const std::uint32_t* cluster_bones;

  const float* matrices;
  std::size_t stride, row, column;  // floats from a matrix to the next, from a row, from a column
  const float* morph_weights;       // null where nothing morphs
};

// How large a bone's matrix is.
struct BoneSize {
  float norm;         // at least the spectral norm of its linear part, but for rounding
  float translation;  // the greatest magnitude of a component
};

struct BoundsInputs {
  std::size_t cluster_count;
  const BoxLanes* boxes;
  const std::uint32_t* term_counts;
  const std::uint32_t* term_bones;
  const BoundsTerm* terms;
  const std::uint32_t* morph_counts;  // null where nothing morphs
  const std::uint32_t* morph_targets;
  const BallLanes* morphs;

  const float* matrices;
  std::size_t stride, row, column;
  const float* morph_weights;
  const BoneSize* sizes;
};

// Of a pose whose bones are checked.
SkinInputs skin_inputs(const Surface& surface, const Pose& pose);
// Writes the sizes of the asset's bones to `sizes`.
BoundsInputs bounds_inputs(const AssetView& asset, const Surface& surface, const Pose& pose, BoneSize* sizes);

// Puts the surface's vertices where the bones have them: positions + stride * v for the source vertex v, in floats;
// other source vertices are left alone. For the repository's own use.
void skin_surface(const Surface& surface, const Pose& pose, Target resolved, float* positions, std::size_t stride);

}  // namespace spherechain
