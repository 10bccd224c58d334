// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "fix/turned_clip.h"

namespace spherechain::baker {

// Channels of rotations, linear between keys, in place of those that a clip has: the joints' own with the turns on top.
// Keys outside of the windows stay as they are; in a window there is one at each frame too. None for what no turn
// moves.
std::vector<Channel> turned_channels(const TurnedClip& clip, const Turns& turns, const std::vector<char>& in_window);

// A GLB in which these channels take the place of an animation's, or, where `animation` is -1, are a new one called
// `clip_name`. What it had is there, byte for byte; new numbers come after it. `file` is for messages. Throws
// Error(kFile) where `glb` is none.
std::string with_channels(const std::string& glb, const std::string& file, const SourceRig& rig, int animation,
                          const std::string& clip_name, const std::vector<Channel>& channels);

}  // namespace spherechain::baker
