// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <vector>

#include "bind/bind.h"
#include "mesh/surface_query.h"

namespace spherechain::baker {

// How far the skins of two spheres are apart at rest: the least distance of a vertex of one from the other's triangles.
class SkinGaps {
 public:
  SkinGaps(const Mesh& skin, const Binding& binding);

  double between(std::uint32_t a, std::uint32_t b) const;

 private:
  struct Skin {
    std::unique_ptr<SurfaceQuery> surface;  // none where the sphere has no triangles
    std::vector<Vec3> vertices;
    Ball around;
  };
  // The least distance, or `bound` where it is no less.
  static double nearest(const Skin& from, const Skin& to, double bound);

  std::vector<Skin> skins_;
};

}  // namespace spherechain::baker
