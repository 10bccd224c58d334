// SPDX-License-Identifier: MIT
// What skinning by leaf reads, its arguments checked: for the jobs and for the kernels (skin_leaf.h).
#pragma once

#include <cstddef>
#include <cstdint>

#include "spherechain/refit_bones.h"
#include "spherechain/simd.h"
#include "spherechain/surface.h"

namespace spherechain {

inline constexpr std::size_t kMaxLeafSlots = 256;

// Bare arrays: kernels are compiled once a target and may use no inline function of the headers.
struct SkinInputs {
  const float* slot_positions;
  const float* slot_weights;
  const SlotMorph* slot_morphs;
  const std::uint32_t* leaf_bones;

  const float* matrices;
  std::size_t stride;          // floats from one matrix to the next
  std::size_t row, column;     // floats from one row of a matrix to the next, and from one column
  const float* morph_weights;  // null where nothing morphs
};

// Of arguments that have passed check_bone_inputs(). For further characters of one asset change `matrices` and
// `morph_weights`.
SkinInputs skin_inputs(const Asset& asset, const BoneMatrices& bones, Span<const float> morph_weights);

// From a first row or column to the next, in floats, in a layout that exists.
constexpr std::size_t row_step(MatrixLayout layout) {
  return layout == MatrixLayout::kRowMajor3x4 || layout == MatrixLayout::kRowMajor4x4 ? 4 : 1;
}
constexpr std::size_t column_step(MatrixLayout layout) {
  return layout == MatrixLayout::kColumnMajor4x4 ? 4 : layout == MatrixLayout::kColumnMajor3x4 ? 3 : 1;
}

}  // namespace spherechain
