// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <utility>
#include <vector>

#include "baker/mesh/mesh.h"

// CGAL's own search for triangles of a mesh that intersect, folds at a common edge or vertex among them: places in
// mesh.triangles, each pair's lesser first, sorted. No edge of the mesh may have more than two triangles.
std::vector<std::pair<std::size_t, std::size_t>> mesh_self_intersections(const spherechain::baker::Mesh& mesh);
