// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/pipeline/pipeline.h"

namespace spherechain::baker {

// The reference that refitted spheres are compared with: the sphere that best keeps its rest F to the vertices around
// it, by least squares of (r - |c - v_i|) - F_i over centre and radius. It does not use pivots, so that every refit
// rule can be compared with it.
class SkinFollower {
 public:
  SkinFollower(const Ball& rest, const std::vector<Vec3>& rest_positions, const std::vector<Index>& vertices);

  // `positions`: the deformed vertices in the order of the rest positions. Gauss-Newton steps start from the rest
  // sphere, moved with the vertices' centroid.
  Ball at(const std::vector<Vec3>& positions) const;

 private:
  Ball rest_;
  std::vector<Index> vertices_;
  std::vector<Vec3> rest_vertices_;
  std::vector<double> rest_f_;
};

// One for each sphere of the bake, from the fitted sphere and those vertices of its triangles with |F| < r / 2.
std::vector<SkinFollower> skin_followers(const Bake& bake);

}  // namespace spherechain::baker
