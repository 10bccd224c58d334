// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "mesh/mesh.h"

namespace spherechain::baker {

// A copy of a mesh in its principal axes, vertices and triangles sorted by position: the same copy, bit for bit,
// whatever the order of the original's vertices and triangles, and all but the last bits whatever its pose, place and
// scale. Algorithms whose result depends on order (edge collapses) see one and the same mesh.
struct CanonicalMesh {
  Mesh mesh;
  Eigen::Matrix3d axes;  // columns: the canonical axes in the original's space
  Vec3 centroid;
  double scale;

  Vec3 to_original(const Vec3& p) const { return centroid + scale * (axes * p); }
};

CanonicalMesh make_canonical(const Mesh& mesh);

}  // namespace spherechain::baker
