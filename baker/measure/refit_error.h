// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pipeline/pipeline.h"

namespace spherechain::baker {

// What a refitted sphere is judged by: the sphere that keeps its rest F to the vertices around it best, the least
// squares of (r - |c - v_i|) - F_i over centre and radius. It knows nothing of pivots, so every refit rule can be
// measured against it.
class SkinFollower {
 public:
  SkinFollower(const Ball& rest, const std::vector<Vec3>& rest_positions, const std::vector<Index>& vertices);

  // `positions`: the deformed vertices, in the order of the rest positions. Gauss and Newton from the rest sphere moved
  // with the vertices' centroid.
  Ball at(const std::vector<Vec3>& positions) const;

 private:
  Ball rest_;
  std::vector<Index> vertices_;
  std::vector<Vec3> rest_vertices_;
  std::vector<double> rest_f_;
};

// One a sphere of the bake, about the fitted sphere and the source vertices of its surrounding region with |F| < r / 2.
std::vector<SkinFollower> skin_followers(const Bake& bake);

}  // namespace spherechain::baker
