// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/fix/solve.h"
#include "baker/fix/turned_clip.h"

namespace spherechain::baker {

// Constraints that keep parts of a frame as in the source clip. They are linearised at the current turns.

// Pinned joints keep their position and orientation.
void add_pinned_joints(const TurnedClip& clip, const std::vector<Index>& joints, int frame, double height,
                       const Turns& turns, std::vector<Constraint>& constraints);
// Keeps the pose of one hand relative to the other.
void add_hand_constraint(const TurnedClip& clip, Index one, Index other, int frame, double height, const Turns& turns,
                         std::vector<Constraint>& constraints);
// Keeps the hinges above these joints within their range.
void add_hinge_limits(const TurnedClip& clip, const std::vector<Index>& joints, int frame,
                      std::vector<Constraint>& constraints);

// For each frame, the hands that stand on something as feet do: as still as feet, and as low.
std::vector<std::vector<Index>> planted_hands(const TurnedClip& clip, const std::vector<Index>& hands,
                                              const std::vector<Index>& feet, const Vec3& up, double height);
// Marks each frame in which two hands hold something together: they are near, and keep their relative pose.
std::vector<char> frames_with_joined_hands(const TurnedClip& clip, Index one, Index other, double height);

}  // namespace spherechain::baker
