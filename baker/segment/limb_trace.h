// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "baker/mesh/attempt.h"
#include "baker/mesh/polyline.h"
#include "baker/mesh/surface_query.h"
#include "baker/segment/body_plan.h"

namespace spherechain::baker {

// A limb's centre line, by marching sections. The curve skeleton only gives the limb's middle and its tip. The line
// from shoulder or hip to wrist or ankle comes from sections, so that it has none of the skeleton's noise.
struct LimbTrace {
  Polyline line;     // from the innermost section that is all limb, to the tip
  Vec3 direction;    // along the line at its start
  double radius;     // the longest ray of the section there
  double extremity;  // arc length of wrist or ankle, the narrowest section before hand or foot; of a tail: of the
                     // centre of its last ball
};

// `branch` comes from the torso. The limb starts outside the torso's maximal ball at the junction, at the innermost
// section all of whose rays end on a wall about as far as the others do: further in, rays escape past armpit or crotch.
// There is none where the branch has no such section; `limb` is its name for people.
Attempt<LimbTrace> trace_limb(const SurfaceQuery& surface, const Polyline& branch, LimbEnd end, const BodyFrame& frame,
                              int rays, const std::string& limb);

// Heights along frame.up from frame.origin.
struct TorsoEnds {
  double crotch;  // where a ray straight down leaves the torso
  double neck;    // the base of the neck: half as wide again as its narrowest part
};

// `hip` and `chest` are points inside the torso, between the legs' and between the arms' starts.
Attempt<TorsoEnds> find_torso_ends(const SurfaceQuery& surface, const Vec3& hip, const Vec3& chest,
                                   const BodyFrame& frame, int rays);

}  // namespace spherechain::baker
