// SPDX-License-Identifier: MIT
#include "random_poses.h"

#include <cmath>

namespace spherechain::test {
namespace {

// About a random axis (Rodrigues).
Matrix turned(float angle, std::mt19937& random) {
  double axis[3] = {}, length = 0;
  while (length < 0.1 || length > 1) {
    length = 0;
    for (double& a : axis) {
      a = uniform(random, -1, 1);
      length += a * a;
    }
  }
  for (double& a : axis) {
    a /= std::sqrt(length);
  }
  const double c = std::cos(angle), s = std::sin(angle);
  Matrix out{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      double value = (1 - c) * axis[row] * axis[column] + (row == column ? c : 0);
      if (row != column) {
        const std::size_t other = 3 - row - column;
        value += (column == (row + 1) % 3 ? -s : s) * axis[other];
      }
      out[4 * row + column] = static_cast<float>(value);
    }
  }
  return out;
}

Matrix random_matrix(PoseKind kind, float size, std::mt19937& random) {
  constexpr float kAll = 3.14159265F;
  Matrix out = turned(uniform(random, -1, 1) * (kind == PoseKind::kGentle ? 0.5F : kAll), random);
  const float shift = kind == PoseKind::kGentle ? size / 20 : size;
  for (std::size_t row = 0; row < 3; ++row) {
    out[4 * row + 3] = shift * uniform(random, -1, 1);
    for (std::size_t column = 0; column < 3; ++column) {
      float& element = out[4 * row + column];
      if (kind == PoseKind::kScaled) element *= 0.25F + 1.5F * static_cast<float>(column);
      if (kind == PoseKind::kSheared) element += uniform(random, -1, 1);
      if (kind == PoseKind::kMirrored && column == 0) element = -element;
      if (kind == PoseKind::kAny) element = uniform(random, -3, 3);
    }
  }
  return out;
}

}  // namespace

std::vector<Matrix> random_pose(std::size_t bones, PoseKind kind, float size, std::mt19937& random) {
  std::vector<Matrix> out;
  for (std::size_t b = 0; b < bones; ++b) {
    out.push_back(random_matrix(kind, size, random));
  }
  return out;
}

std::vector<float> random_morph_weights(std::size_t count, std::mt19937& random) {
  std::vector<float> out;
  for (std::size_t m = 0; m < count; ++m) {
    out.push_back(random() % 3 == 0 ? 0.0F : uniform(random, -2, 2));
  }
  return out;
}

}  // namespace spherechain::test
