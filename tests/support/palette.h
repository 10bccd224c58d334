// SPDX-License-Identifier: MIT
// Bones' matrices in every layout a job takes.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "spherechain/pose.h"
#include "tiny_bones.h"

namespace spherechain::test {

inline constexpr MatrixLayout kLayouts[] = {SC_ROWS_3X4, SC_ROWS_4X4, SC_COLUMNS_4X4, SC_COLUMNS_3X4};

inline std::size_t floats_of(MatrixLayout layout) {
  return layout == SC_ROWS_4X4 || layout == SC_COLUMNS_4X4 ? 16 : 12;
}

// Puts the matrix as its layout has it at `to`.
inline void put_matrix(const Matrix& matrix, MatrixLayout layout, float* to) {
  for (std::size_t at = 0; at < matrix.size(); ++at) {
    const std::size_t row = at / 4, column = at % 4;
    to[layout == SC_COLUMNS_4X4 ? 4 * column + row : layout == SC_COLUMNS_3X4 ? 3 * column + row : at] = matrix[at];
  }
}

// Points at the matrices, rows of 3 by 4 side by side, and at the weights; both must outlive the pose.
inline Pose pose_of(const std::vector<Matrix>& matrices, const std::vector<float>& morph_weights = {}) {
  Pose pose;
  pose.bones = matrices[0].data();
  pose.bone_count = matrices.size();
  pose.bone_layout = SC_ROWS_3X4;
  pose.morph_weights = morph_weights.empty() ? nullptr : morph_weights.data();
  pose.morph_weight_count = morph_weights.size();
  return pose;
}

// The matrices in memory as a game may have them: NaN where nothing may be read.
struct Palette {
  Palette(const std::vector<Matrix>& matrices, MatrixLayout matrix_layout, std::size_t padding_floats)
      : count(matrices.size()), stride(floats_of(matrix_layout) + padding_floats), layout(matrix_layout) {
    memory.assign((count - 1) * stride + floats_of(layout), std::numeric_limits<float>::quiet_NaN());
    for (std::size_t b = 0; b < count; ++b) {
      put_matrix(matrices[b], layout, &memory[b * stride]);
    }
  }
  Pose pose() const {
    Pose out;
    out.bones = memory.data();
    out.bone_count = count;
    out.bone_layout = layout;
    out.bone_stride = stride * sizeof(float);
    return out;
  }

  std::size_t count, stride;  // in floats
  MatrixLayout layout;
  std::vector<float> memory;
};

}  // namespace spherechain::test
