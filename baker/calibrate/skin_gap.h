// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "baker/bind/bind.h"
#include "baker/mesh/surface_query.h"

namespace spherechain::baker {

// Distance of two spheres' skins at rest: the least distance of a vertex of one from the other's triangles.
class SkinGaps {
 public:
  SkinGaps(const Mesh& skin, const Binding& binding);  // the skin must outlive it

  double between(std::uint32_t a, std::uint32_t b) const;

 private:
  struct SphereSkin {
    std::unique_ptr<SurfaceQuery> surface;  // null if the sphere has no triangles
    std::vector<Index> vertices;            // sorted
    Eigen::AlignedBox3d box;                // around its triangles
  };
  // The least distance, at most `bound`.
  double nearest(const SphereSkin& from, const SphereSkin& to, double bound) const;

  const Mesh& mesh_;
  std::vector<SphereSkin> skins_;
};

}  // namespace spherechain::baker
