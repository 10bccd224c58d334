// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

namespace spherechain::quality {

// A ball that moves and grows evenly from one to another: all of them together are their convex hull.
struct Cone {
  Eigen::Vector3d from, to;
  double from_radius, to_radius;
};

// The factor of both cones' radii with which they start to touch: below 1 they overlap. In double precision, by the
// gap's gradient and Dinkelbach's method; nothing of it is the runtime's.
double touching_scale(const Cone& a, const Cone& b);

// The least distance of a ball of the one from a ball of the other, less their radii times `scale`.
double least_gap(const Cone& a, const Cone& b, double scale);

}  // namespace spherechain::quality
