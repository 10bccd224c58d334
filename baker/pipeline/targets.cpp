// SPDX-License-Identifier: GPL-3.0-or-later
// How well a bake fits its character, and which of its targets that misses.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pipeline/pipeline.h"

namespace spherechain::baker {
namespace {

double mean_abs_f(const Bake& bake) {
  double sum = 0;
  for (const TorsoFit& fit : bake.spheres.torso) {
    sum += f_error(fit.phi1_adjusted, bake.character.body, fit.vertices).mean_abs;
  }
  return bake.spheres.torso.empty() ? 0 : sum / static_cast<double>(bake.spheres.torso.size());
}

}  // namespace

double covered_area(const Bake& bake) {
  const Mesh& mesh = bake.character.skin;
  double covered = 0, total = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const BoundSphere& sphere = bake.binding.spheres[bake.binding.sphere_of_triangle[t]];
    const double area = triangle_area(mesh, t);
    total += area;
    if ((triangle_centroid(mesh, t) - sphere.rest.center).norm() <= sphere.detect_radius) covered += area;
  }
  return covered / total;
}

OwnerDistance owner_distance(const Character& character, const Regions& regions, const Binding& binding) {
  std::vector<double> distances;
  double sum = 0;
  for (std::size_t t = 0; t < character.skin.triangles.size(); ++t) {
    const Ball& ball = binding.spheres[binding.sphere_of_triangle[t]].rest;
    distances.push_back(std::abs(signed_f(ball, triangle_centroid(character.skin, t))) / regions.frame.height);
    sum += distances.back();
  }
  std::sort(distances.begin(), distances.end());
  const auto count = static_cast<double>(distances.size());
  return {sum / count, distances[static_cast<std::size_t>(0.95 * count)], distances.back()};
}

std::vector<std::string> missed_targets(const Bake& bake) {
  const Targets& targets = bake.settings.targets;
  std::vector<std::string> missed;
  if (targets.max_spheres && bake.spheres.spheres.size() > *targets.max_spheres) {
    missed.push_back(
        fmt::format("max_spheres: {} asked, {} needed", *targets.max_spheres, bake.spheres.spheres.size()));
  }
  const double f = mean_abs_f(bake) / bake.regions.frame.height;
  if (targets.max_mean_abs_f && f > *targets.max_mean_abs_f) {
    missed.push_back(fmt::format("max_mean_abs_f: {:.4g} asked, {:.4g} reached", *targets.max_mean_abs_f, f));
  }
  const double covered = covered_area(bake);
  if (targets.min_covered_area && covered < *targets.min_covered_area) {
    missed.push_back(fmt::format("min_covered_area: {:.4g} asked, {:.4g} reached", *targets.min_covered_area, covered));
  }
  return missed;
}

}  // namespace spherechain::baker
