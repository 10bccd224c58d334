// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "fix/solve.h"
#include "fix/turned_clip.h"

namespace spherechain::baker {

// Constraints that keep parts of a frame as in the source clip. They are linearised at the current turns.

// Where joints are, and where they point.
void add_pins(const TurnedClip& clip, const std::vector<Index>& joints, int frame, double height, const Turns& turns,
              std::vector<Wish>& wishes);
// Where one joint is as another sees it.
void add_grip(const TurnedClip& clip, Index one, Index other, int frame, double height, const Turns& turns,
              std::vector<Wish>& wishes);
// Hinges that one of these joints hangs on bend no farther than they can.
void add_limits(const TurnedClip& clip, const std::vector<Index>& joints, int frame, std::vector<Wish>& wishes);

// For each frame, the hands that stand on something as feet do: as still as feet, and as low.
std::vector<std::vector<Index>> planted_hands(const TurnedClip& clip, const std::vector<Index>& hands,
                                              const std::vector<Index>& feet, const Vec3& up, double height);
// Marks each frame in which two hands hold something together: they are near, and keep their relative pose.
std::vector<char> gripping_frames(const TurnedClip& clip, Index one, Index other, double height);

}  // namespace spherechain::baker
