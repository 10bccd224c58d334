// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <set>
#include <vector>

#include "baker/fix/turned_clip.h"

namespace spherechain::baker {

// Seconds around a constraint in which joints may turn.
inline constexpr double kWindowPad = 0.35;

// Marks the frames that lie at most kWindowPad away from one of `frames`, or from the frame after it. In a loop, the
// first and the last frame are marked together.
std::vector<char> windows_around(const std::set<int>& frames, const TurnedClip& clip, bool loops);

// The numbers of the marked frames, ascending.
std::vector<int> marked_frames(const std::vector<char>& in_window);

// Splits the marked frames into runs without a gap. In a loop, a run may continue from the last frame to the first.
std::vector<std::vector<std::size_t>> contiguous_runs(const std::vector<char>& in_window, bool loops);

}  // namespace spherechain::baker
