// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "fix/turned_clip.h"

namespace spherechain::baker {

// Frames that lie together in time, window by window; over a loop's seam they are one.
std::vector<std::vector<std::size_t>> spans_of(const std::vector<char>& in_window, bool loops);

// No turn of a joint within so many seconds of what fails; then all of it within as many more.
void taper(const TurnedClip& clip, Index joint, const std::vector<char>& fails, double seconds, bool loops,
           Turns& turns);

}  // namespace spherechain::baker
