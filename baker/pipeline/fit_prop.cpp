// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/pipeline/fit_prop.h"

#include <algorithm>

#include "baker/segment/by_bones.h"

namespace spherechain::baker {
namespace {

// The corners of each sphere's triangles.
std::vector<std::vector<Index>> corners_of(const Mesh& skin, const Spheres& spheres) {
  std::vector<std::vector<Index>> out(spheres.spheres.size());
  for (std::size_t t = 0; t < skin.triangles.size(); ++t) {
    std::vector<Index>& own = out[spheres.of_skin[t]];
    own.insert(own.end(), skin.triangles[t].begin(), skin.triangles[t].end());
  }
  return out;
}

}  // namespace

Attempt<FittedCharacter> fit_prop(const Character& prop, const BakeSettings& settings) {
  constexpr double kRounding = 1e-5;  // of single precision
  FittedCharacter out;
  Regions& regions = out.segmentation.regions;
  regions = segment_by_bones(prop, {}, settings.segment.facing, kPropSpheres);
  out.segmentation.choice.strategy = "prop";
  const Mesh& skin = prop.skin;
  out.spheres = fit_halves(prop, regions, settings.fit);
  const std::vector<std::vector<Index>> corners = corners_of(skin, out.spheres);
  for (std::size_t s = 0; s < corners.size(); ++s) {
    out.spheres.spheres[s].ball = minimum_enclosing_ball(skin, corners[s]);
  }
  Attempt<Binding> binding = bind_spheres(prop, regions, out.spheres, settings.bind);
  if (!binding) return binding.reason();
  out.binding = std::move(*binding);
  // Where pivots lie in a plane, the centre is not the ball's.
  for (std::size_t s = 0; s < corners.size(); ++s) {
    BoundSphere& sphere = out.binding.spheres[s];
    for (const Index v : corners[s]) {
      const double distance = (skin.positions[v] - sphere.rest.center).norm();
      sphere.detect_radius = std::max(sphere.detect_radius, distance * (1 + kRounding));
    }
  }
  out.quality = measure_fit(prop, regions, out.binding);
  return out;
}

}  // namespace spherechain::baker
