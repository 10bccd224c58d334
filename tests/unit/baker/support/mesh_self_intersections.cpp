// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_self_intersections.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <stdexcept>

std::vector<std::pair<std::size_t, std::size_t>> mesh_self_intersections(const spherechain::baker::Mesh& mesh) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;
  using Vertex = SurfaceMesh::Vertex_index;
  SurfaceMesh surface;
  for (const spherechain::baker::Vec3& p : mesh.positions) surface.add_vertex({p.x(), p.y(), p.z()});
  for (const spherechain::baker::Triangle& t : mesh.triangles) {
    if (surface.add_face(Vertex(t[0]), Vertex(t[1]), Vertex(t[2])) == SurfaceMesh::null_face()) {
      throw std::invalid_argument("an edge of the mesh has more than two triangles");
    }
  }
  std::vector<std::pair<SurfaceMesh::Face_index, SurfaceMesh::Face_index>> found;
  CGAL::Polygon_mesh_processing::self_intersections(surface, std::back_inserter(found));
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const auto& [a, b] : found) pairs.push_back(std::minmax(std::size_t{a}, std::size_t{b}));
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}
