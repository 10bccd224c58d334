// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// A curve through points. Arc lengths are measured from its first point.
class Polyline {
 public:
  Polyline() = default;
  explicit Polyline(std::vector<Vec3> points);

  const std::vector<Vec3>& points() const { return points_; }
  double length() const { return arc_.empty() ? 0 : arc_.back(); }
  // Positions before the start and past the end lie on the curve's straight continuation.
  Vec3 at(double s) const;
  // Unit chord over [s - window, s + window].
  Vec3 tangent(double s, double window) const;
  Polyline reversed() const;
  // The part from arc length `from` to `to`.
  Polyline part(double from, double to) const;
  // Arc length of the point of the curve closest to p.
  double closest(const Vec3& p) const;

 private:
  std::vector<Vec3> points_;
  std::vector<double> arc_;
};

}  // namespace spherechain::baker
