// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "fix/turned_clip.h"
#include "play/play.h"

namespace spherechain::baker {

// Movements of feet and hands that the source clip does not have.
struct Comparison {
  double feet_mm = 0, feet_degrees = 0;  // that a foot moves and turns, at most
  double jerk_ratio = 1;                 // of the wrists, where they move by more than 3 mm: after to before
};

// `feet` and `wrists`: joints of the clip.
Comparison compare(const TurnedClip& clip, const Turns& turns, const std::vector<Index>& feet,
                   const std::vector<Index>& wrists, double mm_per_unit);

// The least distance of two body parts that do not meet, in the source's units: of a corner of one from the other's
// triangles.
double distance_between(const AnimatedAsset& animated, const Deformation& pose, std::uint32_t part_a,
                        std::uint32_t part_b);

}  // namespace spherechain::baker
