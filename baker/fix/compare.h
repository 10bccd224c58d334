// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/fix/turned_clip.h"
#include "baker/play/play.h"

namespace spherechain::baker {

// Movements of feet and hands that the source clip does not have.
struct Comparison {
  double feet_mm = 0, feet_degrees = 0;  // largest displacement and turn of a foot
  double jerk_ratio = 1;                 // of the wrists, after to before, where they moved by more than 3 mm
};

// `feet` and `wrists`: joints of the clip.
Comparison compare(const TurnedClip& clip, const Turns& turns, const std::vector<Index>& feet,
                   const std::vector<Index>& wrists, double mm_per_unit);

// The distance of two body parts that do not intersect, in the source's units: the least from a corner of one to the
// other's triangles.
double distance_between(const AnimatedAsset& animated, const Deformation& pose, std::uint32_t part_a,
                        std::uint32_t part_b);

}  // namespace spherechain::baker
