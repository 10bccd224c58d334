// SPDX-License-Identifier: MIT
// Where a line along an axis crosses a triangle.
#pragma once

#include <cstddef>

namespace spherechain {

struct Crossing {
  int side = 0;       // 1: the triangle's front looks along the axis; -1: against it; 0: the line misses it
  double height = 0;  // of the crossing above the line's origin, along the axis
};

// The line through `from`. A line through an edge or a corner counts as if it were shifted a hair, along one axis, then
// along the other: so it crosses a closed surface as often inwards as outwards.
inline Crossing cross_line(const float (&corners)[3][3], const float (&from)[3], std::size_t axis) {
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  double p[3], q[3];
  for (std::size_t k = 0; k < 3; ++k) {
    p[k] = double{corners[k][u]} - double{from[u]};
    q[k] = double{corners[k][v]} - double{from[v]};
  }
  const auto misses = [](const double(&of)[3]) {
    return (of[0] > 0 && of[1] > 0 && of[2] > 0) || (of[0] < 0 && of[1] < 0 && of[2] < 0);
  };
  if (misses(p) || misses(q)) {
    return {};
  }
  double turns[3];  // around the origin, along the edge opposite to each corner
  int left = 0, right = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
    turns[k] = p[i] * q[j] - q[i] * p[j];
    const double after_u = q[i] - q[j], after_v = p[j] - p[i];
    const double decides = turns[k] < 0 || turns[k] > 0 ? turns[k] : after_u < 0 || after_u > 0 ? after_u : after_v;
    left += decides > 0 ? 1 : 0;
    right += decides < 0 ? 1 : 0;
  }
  const double sum = (turns[0] + turns[1]) + turns[2];
  if ((left < 3 && right < 3) || !(sum < 0 || sum > 0)) {
    return {};
  }
  double height = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    height += turns[k] / sum * (double{corners[k][axis]} - double{from[axis]});
  }
  return {left == 3 ? 1 : -1, height};
}

}  // namespace spherechain
