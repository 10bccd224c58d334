// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "brute_force.h"

namespace spherechain::quality {

// Common volume of two bodies, by CGAL's corefinement of their triangles, with holes at their borders filled. Empty if
// CGAL cannot: a body intersects itself, is no manifold, or stays open.
std::optional<double> common_volume(const std::vector<Corners>& a, const std::vector<Corners>& b);

}  // namespace spherechain::quality
