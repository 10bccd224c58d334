// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/bind/bind.h"

namespace spherechain::baker {

enum class FitGrade : std::uint8_t { kGood, kFair, kPoor };
const char* fit_grade_name(FitGrade grade);

// How well the spheres fit the skin at rest. Lengths are fractions of the height. A sphere's skin is that of its
// triangles; in parts that follow bones, where spheres stand along long triangles, the part's skin that is nearest.
struct FitQuality {
  double distance_mean, distance_p95, distance_max;  // of the skin from its sphere's surface, by area
  double far_area;                                   // share of the skin farther than kWellFitted
  double protrusion;                                 // mean distance of the spheres' outer surface from the skin
  std::vector<double> far_of_region;                 // by region: the share of its skin farther than kWellFitted

  // Regions with most of their skin far from the spheres.
  std::vector<std::uint8_t> far_regions() const;

  // Good: at most 5 % far, protrusion at most 0.025. Fair: three times as much, and 0.04.
  FitGrade grade() const;
};

FitQuality measure_fit(const Character& character, const Regions& regions, const Binding& binding);

}  // namespace spherechain::baker
