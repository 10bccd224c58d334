// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <set>
#include <vector>

#include "baker/fix/turned_clip.h"

namespace spherechain::baker {

// Fades out a joint's turns around failed frames: zero up to `seconds` away, full strength at twice that.
void fade_out(const TurnedClip& clip, Index joint, const std::vector<char>& fails, double seconds, bool loops,
              Turns& turns);

// Joints whose turns add shaking: a joint below them has far more jerk than before. `height` is the character's.
std::set<Index> shaking_joints(const TurnedClip& clip, const std::vector<std::size_t>& span, const Turns& turns,
                               double height);

// Smooths a joint's turns in a span with a Gaussian whose standard deviation is `frames`.
void smooth(const TurnedClip& clip, Index joint, const std::vector<std::size_t>& span, double frames, bool loops,
            Turns& turns);

// Smooths the turns in each of these runs of frames until they add no shaking. Removes turns that still shake then,
// because shaking is worse than penetrating. `height` is the character's.
void calm_turns(const TurnedClip& clip, const std::vector<std::vector<std::size_t>>& runs, double height, bool loops,
                Turns& turns);

}  // namespace spherechain::baker
