// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/fix/turned_clip.h"

namespace spherechain::baker {

// New rotation channels, linear between keys, that replace the clip's: its rotations with the turns added. Keys outside
// of the windows stay. Inside a window, each frame gets a key, too. Joints without turns get no channel.
std::vector<Channel> turned_channels(const TurnedClip& clip, const Turns& turns, const std::vector<char>& in_window);

// Writes these channels into a GLB: in place of an animation's, or, if `animation` is -1, as a new one called
// `clip_name`. Existing data stays byte for byte; new numbers are appended. `file` is for messages. Throws
// Error(kFile) if `glb` is not a GLB.
std::string with_channels(const std::string& glb, const std::string& file, const SourceRig& rig, int animation,
                          const std::string& clip_name, const std::vector<Channel>& channels);

}  // namespace spherechain::baker
