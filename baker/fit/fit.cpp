// SPDX-License-Identifier: GPL-3.0-or-later
#include "fit/fit.h"

#include <algorithm>
#include <cmath>

namespace spherechain::baker {

double signed_f(const Ball& ball, const Vec3& vertex) { return ball.radius - (ball.center - vertex).norm(); }

FError f_error(const Ball& ball, const Mesh& mesh, const std::vector<Index>& vertices) {
  FError error;
  for (const Index v : vertices) {
    const double f = std::abs(signed_f(ball, mesh.positions[v]));
    error.mean_abs += f;
    error.max_abs = std::max(error.max_abs, f);
  }
  if (!vertices.empty()) error.mean_abs /= static_cast<double>(vertices.size());
  return error;
}

double penetration_depth(const Ball& a, const Ball& b) {
  return 1 - (a.center - b.center).norm() / (a.radius + b.radius);
}

std::vector<Index> triangles_of_region(const Regions& regions, std::uint8_t region) {
  std::vector<Index> triangles;
  for (Index t = 0; t < regions.of_triangle.size(); ++t) {
    if (regions.of_triangle[t] == region) triangles.push_back(t);
  }
  return triangles;
}

Spheres fit_spheres(const Character& character, const Regions& regions, const FitSettings& settings) {
  Spheres out;
  fit_torso(character.body, regions, settings, character.file, out);
  for (std::uint8_t region = 0; region < kTorso; ++region) {
    for (const FittedSphere& sphere : fit_limb(character.body, regions, region, settings, character.file)) {
      out.spheres.push_back(sphere);
    }
  }
  for (std::uint32_t i = 0; i < out.spheres.size(); ++i) out.of_region[out.spheres[i].region].push_back(i);
  return out;
}

}  // namespace spherechain::baker
