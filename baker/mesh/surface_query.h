// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

struct SurfaceHit {
  Vec3 point;
  double distance;
  Index triangle;  // of the mesh
};

// Ray, segment and closest-point queries against a mesh's triangles, or some of them (CGAL's AABB tree). It keeps its
// own copy of the triangles, of which there must be at least one. Const calls may run in several threads.
class SurfaceQuery {
 public:
  explicit SurfaceQuery(const Mesh& mesh);
  SurfaceQuery(const Mesh& mesh, const std::vector<Index>& triangles);
  ~SurfaceQuery();
  SurfaceQuery(SurfaceQuery&&) noexcept;
  SurfaceQuery& operator=(SurfaceQuery&&) noexcept;

  // The first triangle a ray meets; `direction` need not be of unit length, the distance is in the mesh's units.
  std::optional<SurfaceHit> first_hit(const Vec3& origin, const Vec3& direction) const;
  SurfaceHit closest(const Vec3& point) const;
  bool crosses(const Vec3& from, const Vec3& to) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace spherechain::baker
