// SPDX-License-Identifier: MIT
// Bones' matrices in every layout a job takes.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "spherechain/refit_bones.h"
#include "tiny_bones.h"

namespace spherechain::test {

// Puts the matrix as its layout has it at `to`.
inline void put_matrix(const Matrix& matrix, MatrixLayout layout, float* to) {
  for (std::size_t at = 0; at < matrix.size(); ++at) {
    const std::size_t row = at / 4, column = at % 4;
    to[layout == MatrixLayout::kColumnMajor4x4   ? 4 * column + row
       : layout == MatrixLayout::kColumnMajor3x4 ? 3 * column + row
                                                 : at] = matrix[at];
  }
}

// The matrices in memory as a game may have them: NaN where nothing may be read.
struct Palette {
  Palette(const std::vector<Matrix>& matrices, MatrixLayout matrix_layout, std::size_t matrix_stride)
      : layout(matrix_layout), stride(matrix_stride) {
    memory.assign((matrices.size() - 1) * stride / 4 + size_of(layout) / 4, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t b = 0; b < matrices.size(); ++b) {
      put_matrix(matrices[b], layout, &memory[b * stride / 4]);
    }
  }
  BoneMatrices view(std::size_t count) const { return {memory.data(), count, layout, stride}; }

  std::vector<float> memory;
  MatrixLayout layout;
  std::size_t stride;
};

}  // namespace spherechain::test
