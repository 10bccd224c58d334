// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

// A graph of curves inside a closed surface.
struct CurveSkeleton {
  std::vector<Vec3> points;
  std::vector<std::vector<Index>> neighbours;
};

// CGAL's mean curvature flow skeleton. `mesh` is closed, in one piece.
CurveSkeleton extract_curve_skeleton(const Mesh& mesh);

}  // namespace spherechain::baker
