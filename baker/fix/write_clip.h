// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "fix/turned_clip.h"

namespace spherechain::baker {

// A joint's rotations from its first key to its last, in place of those that a clip has.
struct RotationTrack {
  int node;                      // the file's number
  std::vector<float> times;      // seconds, ascending
  std::vector<float> rotations;  // x y z w a key; linear between keys
};

// The joint's track with the turns on top: keys outside of the windows stay as they are; in a window there is one at
// each frame too. None where no turn moves it.
std::vector<RotationTrack> turned_tracks(const TurnedClip& clip, const Turns& turns,
                                         const std::vector<char>& in_window);

// A GLB in which these tracks take the place of an animation's rotations. What it had is there, byte for byte; new
// numbers come after it. `name` is for messages. Throws Error(kFile) where `glb` is none.
std::string with_tracks(const std::string& glb, const std::string& name, const SourceRig& rig, int animation,
                        const std::vector<RotationTrack>& tracks);

}  // namespace spherechain::baker
