// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/wrap/alpha_wrap.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/alpha_wrap_3.h>

#include <algorithm>

#include "baker/mesh/canonical_mesh.h"

namespace spherechain::baker {

Mesh alpha_wrap(const Mesh& mesh, double alpha, double offset) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;
  // CGAL starts from a box along the axes and takes the triangles in their order.
  const CanonicalMesh canonical = make_canonical(mesh);
  std::vector<Kernel::Point_3> points;
  points.reserve(canonical.mesh.positions.size());
  for (const Vec3& p : canonical.mesh.positions) points.emplace_back(p.x(), p.y(), p.z());
  // CGAL leaves triangles without an area out, and crashes where none is left.
  const auto is_line = [&](const Triangle& t) { return CGAL::collinear(points[t[0]], points[t[1]], points[t[2]]); };
  if (std::ranges::all_of(canonical.mesh.triangles, is_line)) return {};
  SurfaceMesh wrap;
  CGAL::alpha_wrap_3(points, canonical.mesh.triangles, alpha / canonical.scale, offset / canonical.scale, wrap);

  Mesh out;
  std::vector<Index> place(wrap.number_of_vertices(), kNoIndex);
  for (const auto v : wrap.vertices()) {
    place[v] = static_cast<Index>(out.positions.size());
    const Kernel::Point_3& p = wrap.point(v);
    out.positions.push_back(canonical.to_original(Vec3(p.x(), p.y(), p.z())));
  }
  for (const auto f : wrap.faces()) {
    Triangle triangle{};
    std::size_t k = 0;
    for (const auto v : CGAL::vertices_around_face(wrap.halfedge(f), wrap)) triangle[k++] = place[v];
    out.triangles.push_back(triangle);
  }
  return out;
}

}  // namespace spherechain::baker
