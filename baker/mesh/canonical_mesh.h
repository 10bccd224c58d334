// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// A copy of a mesh in its principal axes, with vertices and triangles sorted by position. It is meant for algorithms
// whose result depends on order (edge collapses). The copy is the same to the bit whatever the order of the original's
// vertices and triangles, and the same but for rounding whatever its orientation, place and scale.
struct CanonicalMesh {
  Mesh mesh;
  Eigen::Matrix3d axes;  // columns: the canonical axes in the original's space
  Vec3 centroid;
  double scale;

  Vec3 to_original(const Vec3& p) const { return centroid + scale * (axes * p); }
};

CanonicalMesh make_canonical(const Mesh& mesh);

}  // namespace spherechain::baker
