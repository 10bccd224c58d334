// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "fix/turned_clip.h"

namespace spherechain::baker {

struct LimbInTrouble;

// A frame with its joints turned otherwise.
struct TriedPose {
  int frame;
  std::vector<Vec3> turns;  // of each joint
};

// How much is in each other in poses, in heights; 0: nothing.
using JudgePoses = std::function<std::vector<double>(const std::vector<TriedPose>&)>;

// Turns of a limb's joints that free it, tried out: joint by joint and axis by axis, up to `budget` radians, in the
// worst frames. Each frame follows the way of one of these, as far as it must; which, is what costs least and is
// steadiest over all frames. A frame that nothing frees has what is best. Of each frame: all joints' turns, `start` but
// for the limb's.
std::map<int, std::vector<Vec3>> find_way_out(const TurnedClip& clip, const LimbInTrouble& limb, double budget,
                                              const Turns& start, const JudgePoses& judge);

}  // namespace spherechain::baker
