// SPDX-License-Identifier: MIT
// Bones' matrices in every layout a job takes.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "spherechain/refit_bones.h"
#include "tiny_bones.h"

namespace spherechain::test {

// The matrices in memory as a game may have them: NaN where nothing may be read.
struct Palette {
  Palette(const std::vector<Matrix>& matrices, MatrixLayout matrix_layout, std::size_t matrix_stride)
      : layout(matrix_layout), stride(matrix_stride) {
    memory.assign((matrices.size() - 1) * stride / 4 + size_of(layout) / 4, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t b = 0; b < matrices.size(); ++b) {
      for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 4; ++column) {
          const std::size_t at = layout == MatrixLayout::kColumnMajor4x4   ? 4 * column + row
                                 : layout == MatrixLayout::kColumnMajor3x4 ? 3 * column + row
                                                                           : 4 * row + column;
          memory[b * stride / 4 + at] = matrices[b][4 * row + column];
        }
      }
    }
  }
  BoneMatrices view(std::size_t count) const { return {memory.data(), count, layout, stride}; }

  std::vector<float> memory;
  MatrixLayout layout;
  std::size_t stride;
};

}  // namespace spherechain::test
