// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Min_sphere_of_points_d_traits_3.h>
#include <CGAL/Min_sphere_of_spheres_d.h>
#include <CGAL/Simple_cartesian.h>

#include "fit/fit.h"

namespace spherechain::baker {

Ball minimum_enclosing_ball(const Mesh& mesh, const std::vector<Index>& vertices) {
  using Kernel = CGAL::Simple_cartesian<double>;
  using MinSphere = CGAL::Min_sphere_of_spheres_d<CGAL::Min_sphere_of_points_d_traits_3<Kernel, double>>;
  std::vector<Kernel::Point_3> points;
  points.reserve(vertices.size());
  for (const Index v : vertices)
    points.emplace_back(mesh.positions[v].x(), mesh.positions[v].y(), mesh.positions[v].z());
  MinSphere sphere(points.begin(), points.end());
  const auto* c = sphere.center_cartesian_begin();
  return {Vec3(c[0], c[1], c[2]), sphere.radius()};
}

}  // namespace spherechain::baker
