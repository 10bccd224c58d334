// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "baker/mesh/mesh.h"
#include "baker/mesh/surface_query.h"

namespace spherechain::baker {

// Rays from one centre in all directions of a plane (the paper's section 3). Their hits are the cross-section around
// it.
struct Ring {
  Vec3 center, normal;
  Vec3 u, v;  // with `normal` a right-handed orthonormal frame; ray k points to cos(a) u + sin(a) v, a = 2 pi k / N_r
  std::vector<std::optional<SurfaceHit>> hits;

  // Median over the hits; 0 without any.
  double median_distance() const;
  // The centroid of the polygon through the hits; the centre itself where fewer than three rays hit.
  Vec3 section_centroid() const;
};

// `reference` is any vector that is not parallel to `normal`. Ray 0 points along its part in the plane, so that rings
// turn with the mesh.
Ring cast_ring(const SurfaceQuery& surface, const Vec3& center, const Vec3& normal, const Vec3& reference, int rays);

}  // namespace spherechain::baker
