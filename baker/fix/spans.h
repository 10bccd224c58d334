// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <set>
#include <vector>

#include "fix/turned_clip.h"

namespace spherechain::baker {

// Frames that lie together in time, window by window; over a loop's seam they are one.
std::vector<std::vector<std::size_t>> spans_of(const std::vector<char>& in_window, bool loops);

// No turn of a joint within so many seconds of what fails; then all of it within as many more.
void taper(const TurnedClip& clip, Index joint, const std::vector<char>& fails, double seconds, bool loops,
           Turns& turns);

// The joints that turn what shakes there and did not: whose jerk is much more than it was. `height` is the character's.
std::set<Index> shaking_joints(const TurnedClip& clip, const std::vector<std::size_t>& span, const Turns& turns,
                               double height);

// A joint's turns in a span, each the mean of what lies around it in time, by a bell of so many frames.
void smooth(const TurnedClip& clip, Index joint, const std::vector<std::size_t>& span, double frames, bool loops,
            Turns& turns);

}  // namespace spherechain::baker
