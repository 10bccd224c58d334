// SPDX-License-Identifier: MIT
// Positions inside a caller's vertex buffer.
#pragma once

#include <cstddef>

namespace spherechain {

constexpr bool is_valid_stride(std::size_t stride) {
  return stride >= 3 * sizeof(float) && stride % sizeof(float) == 0;
}

inline const float* vertex_at(const float* positions, std::size_t index, std::size_t stride) {
  return positions + index * (stride / sizeof(float));
}

}  // namespace spherechain
