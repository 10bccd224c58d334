// SPDX-License-Identifier: GPL-3.0-or-later
#include "corefinement.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/corefinement.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include <array>

namespace spherechain::quality {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
namespace pmp = CGAL::Polygon_mesh_processing;

std::optional<Mesh> closed(const std::vector<Corners>& triangles) {
  std::vector<Kernel::Point_3> points;
  std::vector<std::array<std::size_t, 3>> polygons;
  for (const Corners& t : triangles) {
    polygons.push_back({points.size(), points.size() + 1, points.size() + 2});
    for (const Vec3& p : t.p) points.emplace_back(p.x(), p.y(), p.z());
  }
  pmp::repair_polygon_soup(points, polygons);
  if (!pmp::is_polygon_soup_a_polygon_mesh(polygons)) return std::nullopt;
  Mesh mesh;
  pmp::polygon_soup_to_polygon_mesh(points, polygons, mesh);
  std::vector<Mesh::Halfedge_index> borders;
  pmp::extract_boundary_cycles(mesh, std::back_inserter(borders));
  for (const Mesh::Halfedge_index border : borders) {
    std::vector<Mesh::Face_index> patch;
    pmp::triangulate_hole(mesh, border, std::back_inserter(patch));
  }
  if (!CGAL::is_closed(mesh) || pmp::does_self_intersect(mesh)) return std::nullopt;
  if (!pmp::does_bound_a_volume(mesh)) return std::nullopt;
  return mesh;
}

}  // namespace

std::optional<double> common_volume(const std::vector<Corners>& a, const std::vector<Corners>& b) {
  try {
    std::optional<Mesh> first = closed(a), second = closed(b);
    if (!first || !second) return std::nullopt;
    Mesh common;
    if (!pmp::corefine_and_compute_intersection(*first, *second, common)) return std::nullopt;
    return std::abs(CGAL::to_double(pmp::volume(common)));
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

}  // namespace spherechain::quality
