// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/score/movement.h"

#include <algorithm>
#include <cmath>

namespace spherechain::baker {

double mean_difference(const Track& track, int order, double fps) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t f = static_cast<std::size_t>(order); f < track.size(); ++f) {
    for (std::size_t p = 0; p < track[f].size(); ++p) {
      Vec3 difference = Vec3::Zero();
      double share = 1;  // binomial, with signs
      for (int k = 0; k <= order; ++k) {
        difference += share * track[f - static_cast<std::size_t>(k)][p];
        share *= -static_cast<double>(order - k) / (k + 1);
      }
      sum += difference.norm();
      ++count;
    }
  }
  return count > 0 ? sum / static_cast<double>(count) * std::pow(fps, order) : 0;
}

double mean_distance(const Track& a, const Track& b) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t f = 0; f < std::min(a.size(), b.size()); ++f) {
    for (std::size_t p = 0; p < std::min(a[f].size(), b[f].size()); ++p, ++count) sum += (a[f][p] - b[f][p]).norm();
  }
  return count > 0 ? sum / static_cast<double>(count) : 0;
}

}  // namespace spherechain::baker
