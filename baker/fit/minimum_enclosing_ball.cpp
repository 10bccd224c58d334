// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Min_sphere_of_points_d_traits_3.h>
#include <CGAL/Min_sphere_of_spheres_d.h>
#include <CGAL/Simple_cartesian.h>

#include "baker/fit/fit.h"

namespace spherechain::baker {

Ball minimum_enclosing_ball(const std::vector<Vec3>& points) {
  using Kernel = CGAL::Simple_cartesian<double>;
  using MinSphere = CGAL::Min_sphere_of_spheres_d<CGAL::Min_sphere_of_points_d_traits_3<Kernel, double>>;
  std::vector<Kernel::Point_3> copies;
  copies.reserve(points.size());
  for (const Vec3& p : points) copies.emplace_back(p.x(), p.y(), p.z());
  MinSphere sphere(copies.begin(), copies.end());
  const auto* c = sphere.center_cartesian_begin();
  return {Vec3(c[0], c[1], c[2]), sphere.radius()};
}

Ball minimum_enclosing_ball(const Mesh& mesh, const std::vector<Index>& vertices) {
  std::vector<Vec3> points;
  points.reserve(vertices.size());
  for (const Index v : vertices) points.push_back(mesh.positions[v]);
  return minimum_enclosing_ball(points);
}

}  // namespace spherechain::baker
