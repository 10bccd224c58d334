// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// Eigen's decompositions, compiled once: their templates take seconds in each file that uses them.

// The eigenvalues of a symmetric matrix, ascending, and a column for each.
struct PrincipalAxes {
  Vec3 values;
  Eigen::Matrix3d vectors;
};
PrincipalAxes principal_axes(const Eigen::Matrix3d& symmetric);

// matrix = u * values * v', where the values descend and none is negative.
struct Singular {
  Eigen::Matrix3d u;
  Vec3 values;
  Eigen::Matrix3d v;
};
Singular singular_values(const Eigen::Matrix3d& matrix);

// linear = turn * stretch, where the turn has no mirror in it: the stretch has.
struct TurnAndStretch {
  Eigen::Matrix3d turn, stretch;
};
TurnAndStretch turn_and_stretch(const Eigen::Matrix3d& linear);
Eigen::Matrix3d turn_in(const Eigen::Matrix3d& linear);

// The least turn that brings one direction onto another; neither need have unit length.
Eigen::Quaterniond turn_between(const Vec3& from, const Vec3& to);

}  // namespace spherechain::baker
