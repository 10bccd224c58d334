// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "fit/fit.h"
#include "import/import.h"
#include "segment/segment.h"

namespace spherechain::baker {

// How centre and radius follow the pivots. paper: section 5.1; calibrated: exact at rest; moments: the same with root
// mean squares (see runtime/refit.h). Never asked for: what a calibrated binding becomes where bones allow it.
enum class RefitRule : std::uint8_t { kPaper = 0, kCalibrated = 1, kMoments = 2 };

struct BoundPivot {
  Index triangle;  // of Character::skin
  double weight;
};

struct BoundSphere {
  Ball rest;             // what refit gives in the rest pose: the fitted sphere, but for the paper's rule and spikes
  double detect_radius;  // rest
  double spread;         // mean distance of the pivots' centroids from the centre at rest; moments: root mean square
  std::vector<BoundPivot> pivots;
  double weight_sum;  // sum of |weight|: 1 means the centre lies inside the pivots' hull
};

struct BoundPair {
  std::uint32_t a, b;  // a < b
  double reach;        // reported only when closer than reach * (ra + rb)
};

struct Binding {
  RefitRule rule;
  std::vector<std::uint32_t>
      sphere_of_triangle;  // a triangle of Character::skin -> the sphere whose surrounding region it is in
  std::vector<BoundSphere> spheres;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ignored;  // a < b, sorted
  std::vector<BoundPair> near_fit, near_detect;  // not ignored, and touching when a little nearer than at rest; sorted
};

struct BindSettings {
  RefitRule rule = RefitRule::kCalibrated;  // or kPaper
  int pivots = 8;                           // of a sphere; calibrated: more where so many are ill-posed
  double detect_quantile = 0.9;             // of the surrounding region's area, by distance from the centre
  double rest_fraction = 0.9;               // of the rest distance: see near_fit
  double neighbour_gap = 0;  // of the height: regions with a shorter way between them on the mesh are ignored too
};

// Throws Error(kSegmentation) where a sphere finds no pivots.
Binding bind_spheres(const Character& character, const Regions& regions, const Spheres& spheres,
                     const BindSettings& settings);

// The pivots of one sphere among the triangles of its surrounding region. The paper's rule takes `count` of them, or
// none where there are not as many. The calibrated rule takes `count`, or all where there are fewer, or up to 16 where
// those would need weights whose magnitudes add up to more than 1.5; none where that does not help either.
std::vector<BoundPivot> choose_pivots(const Mesh& mesh, const std::vector<Index>& triangles, const FittedSphere& sphere,
                                      const Vec3& reference, RefitRule rule, int count);

// For a sphere in a spike of few triangles, which none carry as it is: those of the calibrated rule that come nearest
// to it, with weights that do add up to no more than 1.5 and a centre drawn towards the pivots. None where there are
// fewer than four that do not lie in a plane.
std::vector<BoundPivot> choose_nearest_pivots(const Mesh& mesh, const std::vector<Index>& triangles,
                                              const FittedSphere& sphere, const Vec3& reference, int count);

}  // namespace spherechain::baker
