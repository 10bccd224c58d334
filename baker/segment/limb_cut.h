// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "mesh/polyline.h"
#include "mesh/surface_query.h"
#include "segment/body_plan.h"

namespace spherechain::baker {

// A skeleton branch moved to the middle of the cross-sections it runs through: what is left of the skeleton's noise is
// where sections say nothing (inside the torso, in the palm).
Polyline centre_in_sections(const SurfaceQuery& surface, const Polyline& branch, const BodyFrame& frame, int rays);

struct LimbCut {
  double start;      // arc length at which the limb leaves the torso
  double radius;     // the longest ray of the section there
  double extremity;  // arc length of its narrowest section before hand or foot: wrist or ankle
};

// `line` comes from the torso. The limb starts outside the torso's maximal ball at the junction, at the innermost section
// that is still the limb's own: all its rays end on a wall about as far as the others do (further in, rays escape past
// armpit or crotch). Throws Error(kSegmentation) where there is no such section.
LimbCut find_limb_cut(const SurfaceQuery& surface, const Polyline& line, const BodyFrame& frame, int rays,
                      const std::string& limb, const std::string& file);

// Arc length on the head's line at which the neck rises from the shoulders: the lowest section, of those that lead to the
// narrowest one, whose mean ray is at most 1.5 times the narrowest's.
double find_neck_base(const SurfaceQuery& surface, const Polyline& head, const BodyFrame& frame, int rays);

// Arc length of the narrowest section of `line` between two arc lengths, by the mean ray.
double narrowest_section(const SurfaceQuery& surface, const Polyline& line, double from, double to,
                         const BodyFrame& frame, int rays);

}  // namespace spherechain::baker
