// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "baker/fit/fit.h"
#include "baker/import/import.h"
#include "baker/segment/segment.h"

namespace spherechain::baker {

// How a sphere's centre and radius follow its pivots (docs/arithmetic.md). kPaper: section 5.1 of the paper. kMoments:
// exact at rest; the radius follows the root mean square of the pivots' distances.
enum class RefitRule : std::uint8_t { kPaper = 0, kMoments = 1 };

struct BoundPivot {
  Index triangle;  // of Character::skin
  double weight;
};

struct BoundSphere {
  Ball rest;  // the refit in the rest pose; differs from the fitted sphere under the paper's rule and in spikes
  double detect_radius;  // at rest
  double spread;         // root mean square (paper: mean) distance of the pivots' centroids from the centre at rest
  std::vector<BoundPivot> pivots;
  double weight_sum;                 // sum of |weight|: 1 means the centre lies inside the pivots' hull
  bool keeps_detect_radius = false;  // a person chose the detect radius
};

// Two spheres that are reported only when they are closer than rest_scale * (radius of a + radius of b). Most of them
// touch at rest, or would touch soon.
struct BoundPair {
  std::uint32_t a, b;  // a < b
  float rest_scale;    // below 1, in the precision of the asset
};

struct Binding {
  RefitRule rule;
  std::vector<std::uint32_t> sphere_of_triangle;  // a triangle of Character::skin -> the sphere it belongs to
  std::vector<BoundSphere> spheres;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> ignored;  // a < b, sorted
  std::vector<BoundPair> rest_fit, rest_detect;                  // by the fit and the detect radii; not ignored; sorted
};

// The paper's rest pairs are reported below this part of their distance at rest; those of moments are calibrated
// (calibrate/calibrate.h).
inline constexpr double kPaperRestScale = 0.9;

struct BindSettings {
  RefitRule rule = RefitRule::kMoments;
  int pivots = 8;                // of a sphere; moments: more where 8 are ill-posed
  double detect_quantile = 0.9;  // of the area of the sphere's triangles, by distance from the centre
  double neighbour_gap = 0;      // of the height: spheres this close along the mesh are ignored, too
};

// Fails if a sphere finds no pivots. Under the rule of moments, the calibration finds the rest pairs.
Attempt<Binding> bind_spheres(const Character& character, const Regions& regions, const Spheres& spheres,
                              const BindSettings& settings);

// The sphere of each triangle of the skin: the closest of its region (section 5.1); of a tree as it was fitted.
std::vector<std::uint32_t> assign_triangles(const Mesh& skin, const Regions& regions, const Spheres& spheres);

// Largest sum of a sphere's absolute weights. Above 1, the sphere moves more than its pivots do.
inline constexpr double kIllPosed = 1.5;

// Chooses the pivots of one sphere among its triangles. Under the paper's rule: `count` of them, or none where there
// are fewer. Under the rule of moments: `count`, or all where there are fewer. Where the magnitudes of their weights
// add up to more than 1.5, up to 16; none where they still add up to more than `magnitudes_max`.
std::vector<BoundPivot> choose_pivots(const Mesh& mesh, const std::vector<Index>& triangles, const FittedSphere& sphere,
                                      const Vec3& reference, RefitRule rule, int count,
                                      double magnitudes_max = kIllPosed);

// Fallback for a sphere without pivots from choose_pivots() (in a spike of few triangles): pivots of the rule of
// moments whose absolute weights add up to at most 1.5. The centre moves towards them. Empty if there are fewer than
// four that do not lie in a plane.
std::vector<BoundPivot> choose_nearest_pivots(const Mesh& mesh, const std::vector<Index>& triangles,
                                              const FittedSphere& sphere, const Vec3& reference, int count);

// Fallback for a sphere without pivots from choose_nearest_pivots(): the 16 triangles nearest to its centre (all if
// there are fewer), with equal weights. The centre moves to their mean.
std::vector<BoundPivot> choose_even_pivots(const Mesh& mesh, const std::vector<Index>& triangles,
                                           const FittedSphere& sphere);

}  // namespace spherechain::baker
