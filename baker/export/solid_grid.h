// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "baker/volumes/volume.h"

namespace spherechain::baker {

inline bool inside_any(const std::vector<Volume>& volumes, const Vec3& point) {
  return std::any_of(volumes.begin(), volumes.end(),
                     [&](const Volume& volume) { return signed_distance(volume, point) < 0; });
}

// The cells of a grid around the volumes, 32 along the longest side: each one's centre and size.
template <typename Visit>
void for_each_solid_cell(const std::vector<Volume>& volumes, const Visit& visit) {
  constexpr double kCells = 32, kCellsMin = 8;
  if (volumes.empty()) return;
  Vec3 low = Vec3::Constant(INFINITY), high = -low;
  for (const Volume& volume : volumes) {
    for (int k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], support(volume, -Vec3::Unit(k))[k]);
      high[k] = std::max(high[k], support(volume, Vec3::Unit(k))[k]);
    }
  }
  const Vec3 size = high - low;
  if (!(size.minCoeff() > 0)) return;
  const Vec3 counts = (kCells / size.maxCoeff() * size).array().ceil().cwiseMax(kCellsMin);
  const Vec3 cell = size.cwiseQuotient(counts);
  const Eigen::Vector3i n = counts.cast<int>();
  for (int x = 0; x < n.x(); ++x) {
    for (int y = 0; y < n.y(); ++y) {
      for (int z = 0; z < n.z(); ++z) visit(Vec3(low + cell.cwiseProduct(Vec3(x + 0.5, y + 0.5, z + 0.5))), cell);
    }
  }
}

}  // namespace spherechain::baker
