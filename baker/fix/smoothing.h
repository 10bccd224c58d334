// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "baker/fix/turned_clip.h"

namespace spherechain::baker {

// By joint: 1 for each frame in which something is wrong with its turn.
using MarkedTurns = std::map<Index, std::vector<char>>;

// Takes a joint's turns down to a share of `least` in the marked frames; they come back within `seconds` around.
void fade_out(const TurnedClip& clip, Index joint, const std::vector<char>& marked, double seconds, double least,
              bool loops, Turns& turns);

// Turns that one sees as a correction: around a frame, a joint below has far more jerk than in the source clip, or from
// one frame to the next it goes further than there, by a hundredth of the character's height or more.
MarkedTurns shaking_turns(const TurnedClip& clip, const Turns& turns, double height);

// Spreads and smooths turns where they shake. Fades out what still shakes then, because shaking is worse than
// penetrating.
void calm_turns(const TurnedClip& clip, double height, bool loops, Turns& turns);

}  // namespace spherechain::baker
