// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/mesh/decompose.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace spherechain::baker {

PrincipalAxes principal_axes(const Eigen::Matrix3d& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Singular singular_values(const Eigen::Matrix3d& matrix) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.matrixU(), svd.singularValues(), svd.matrixV()};
}

TurnAndStretch turn_and_stretch(const Eigen::Matrix3d& linear) {
  TurnAndStretch out;
  Eigen::Affine3d(linear).computeRotationScaling(&out.turn, &out.stretch);
  return out;
}

Eigen::Matrix3d turn_in(const Eigen::Matrix3d& linear) { return Eigen::Affine3d(linear).rotation(); }

Eigen::Quaterniond turn_between(const Vec3& from, const Vec3& to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to);
}

}  // namespace spherechain::baker
