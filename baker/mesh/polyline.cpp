// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/polyline.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace spherechain::baker {

Polyline::Polyline(std::vector<Vec3> points) {
  for (const Vec3& p : points) {
    if (!points_.empty() && (p - points_.back()).squaredNorm() == 0) continue;
    arc_.push_back(points_.empty() ? 0.0 : arc_.back() + (p - points_.back()).norm());
    points_.push_back(p);
  }
}

Vec3 Polyline::at(double s) const {
  if (points_.size() == 1) return points_.front();
  const auto next = std::upper_bound(arc_.begin() + 1, arc_.end() - 1, s) - arc_.begin();
  const auto i = static_cast<std::size_t>(next);
  const double f = (s - arc_[i - 1]) / (arc_[i] - arc_[i - 1]);
  return points_[i - 1] + f * (points_[i] - points_[i - 1]);
}

Vec3 Polyline::tangent(double s, double window) const {
  const double low = std::max(0.0, s - window), high = std::min(length(), s + window);
  return high > low ? Vec3((at(high) - at(low)).normalized()) : Vec3((at(s + window) - at(s - window)).normalized());
}

Polyline Polyline::reversed() const { return Polyline(std::vector<Vec3>(points_.rbegin(), points_.rend())); }

Polyline Polyline::part(double from, double to) const {
  std::vector<Vec3> points{at(from)};
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (arc_[i] > from && arc_[i] < to) points.push_back(points_[i]);
  }
  points.push_back(at(to));
  return Polyline(std::move(points));
}

double Polyline::closest(const Vec3& p) const {
  double best = std::numeric_limits<double>::max(), s = 0;
  for (std::size_t i = 1; i < points_.size(); ++i) {
    const Vec3 edge = points_[i] - points_[i - 1];
    const double f = std::clamp((p - points_[i - 1]).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    const double d = (points_[i - 1] + f * edge - p).squaredNorm();
    if (d < best) {
      best = d;
      s = arc_[i - 1] + f * (arc_[i] - arc_[i - 1]);
    }
  }
  return s;
}

}  // namespace spherechain::baker
