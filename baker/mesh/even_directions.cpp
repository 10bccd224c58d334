// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/even_directions.h"

#include <cmath>
#include <numbers>

namespace spherechain::baker {

std::vector<Vec3> even_directions(int count) {
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0));
  std::vector<Vec3> out;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z);
    out.emplace_back(r * std::cos(i * turn), r * std::sin(i * turn), z);
  }
  return out;
}

}  // namespace spherechain::baker
