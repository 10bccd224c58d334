// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <array>

namespace spherechain::baker {

// Angles in degrees about three axes, each 0 (x) to 2 (z) once, the outermost first: the last turn of the three that
// turn a vector.
using EulerAxes = std::array<int, 3>;

Eigen::Quaterniond rotation_by(const EulerAxes& axes, const Eigen::Vector3d& degrees);

// The angles that give a rotation: the nearest to `near` if several do.
Eigen::Vector3d angles_near(const Eigen::Quaterniond& rotation, const EulerAxes& axes, const Eigen::Vector3d& near);

}  // namespace spherechain::baker
