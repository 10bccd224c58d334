// SPDX-License-Identifier: MIT
// The inner loop of CoverJob, and what else bounds leaves from bones reads.
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/refit_bones.h"
#include "spherechain/simd.h"
#include "spherechain/surface.h"
#include "spherechain/types.h"

namespace spherechain {

// How large a bone's matrix is.
struct BoneSize {
  float norm;         // at least the spectral norm of its linear part, but for rounding
  float translation;  // the greatest magnitude of a component
};

// Bare arrays: kernels are compiled once a target and may use no inline function of the headers.
struct CoverInputs {
  std::size_t leaf_count;
  const BallLanes* balls;
  const BoxLanes* boxes;  // null in assets of older bakers
  const std::uint32_t* term_counts;
  const std::uint32_t* term_bones;
  const CoverTerm* terms;
  const std::uint32_t* morph_counts;  // null where nothing morphs
  const std::uint32_t* morph_targets;
  const BallLanes* morphs;

  const float* matrices;
  std::size_t stride, row, column;  // floats from a matrix to the next, from a row, from a column
  const float* morph_weights;
  const BoneSize* sizes;   // of the first bones
  std::size_t size_count;  // how many
};

BoneSize bone_size(const CoverInputs& inputs, std::size_t bone);

// Of arguments that have passed check_bone_inputs(). Sizes are worked out for as many bones as `sizes` has room for.
CoverInputs cover_inputs(const Asset& asset, const BoneMatrices& bones, Span<const float> morph_weights,
                         Span<BoneSize> sizes);

// All leaves of the asset.
void cover_leaves_from_bones(const CoverInputs& inputs, Target resolved, Sphere* leaves);

}  // namespace spherechain
