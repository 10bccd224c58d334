// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "fit/fit.h"
#include "import/import.h"
#include "segment/segment.h"

namespace spherechain::baker {

// How centre and radius follow the pivots (docs/arithmetic.md). paper: section 5.1 of the paper. moments: exact at rest,
// the radius with the root mean square of the pivots' distances.
enum class RefitRule : std::uint8_t { kPaper = 0, kMoments = 1 };

struct BoundPivot {
  Index triangle;  // of Character::skin
  double weight;
};

struct BoundSphere {
  Ball rest;             // what refit gives in the rest pose: the fitted sphere, but for the paper's rule and spikes
  double detect_radius;  // rest
  double spread;         // root mean square (paper: mean) distance of the pivots' centroids from the centre at rest
  std::vector<BoundPivot> pivots;
  double weight_sum;  // sum of |weight|: 1 means the centre lies inside the pivots' hull
};

struct BoundPair {
  std::uint32_t a, b;  // a < b
  double rest_scale;   // reported only when closer than rest_scale * (ra + rb)
};

struct Binding {
  RefitRule rule;
  std::vector<std::uint32_t>
      sphere_of_triangle;  // a triangle of Character::skin -> the sphere whose triangles it is in
  std::vector<BoundSphere> spheres;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ignored;  // a < b, sorted
  std::vector<BoundPair> rest_fit, rest_detect;  // not ignored, and touching when a little nearer than at rest; sorted
};

struct BindSettings {
  RefitRule rule = RefitRule::kMoments;
  int pivots = 8;                           // of a sphere; moments: more where so many are ill-posed
  double detect_quantile = 0.9;             // of the area of its triangles, by distance from the centre
  double rest_scale = 0.9;                  // of the rest distance: see rest_fit
  double neighbour_gap = 0;  // of the height: regions with a shorter way between them on the mesh are ignored too
};

// Throws Error(kSegmentation) where a sphere finds no pivots.
Binding bind_spheres(const Character& character, const Regions& regions, const Spheres& spheres,
                     const BindSettings& settings);

// The pivots of one sphere among the triangles of its triangles. The paper's rule takes `count` of them, or
// none where there are not as many. The rule of moments takes `count`, or all where there are fewer, or up to 16 where
// those would need weights whose magnitudes add up to more than 1.5; none where that does not help either.
std::vector<BoundPivot> choose_pivots(const Mesh& mesh, const std::vector<Index>& triangles, const FittedSphere& sphere,
                                      const Vec3& reference, RefitRule rule, int count);

// For a sphere in a spike of few triangles, which none carry as it is: those of the rule of moments that come nearest
// to it, with weights that do add up to no more than 1.5 and a centre drawn towards the pivots. None where there are
// fewer than four that do not lie in a plane.
std::vector<BoundPivot> choose_nearest_pivots(const Mesh& mesh, const std::vector<Index>& triangles,
                                              const FittedSphere& sphere, const Vec3& reference, int count);

}  // namespace spherechain::baker
