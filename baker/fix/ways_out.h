// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "fix/turned_clip.h"

namespace spherechain::baker {

// A frame with its joints turned otherwise.
struct TriedPose {
  int frame;
  std::vector<Vec3> turns;  // of each joint
};

// How much is in each other in poses; 0: nothing.
using JudgePoses = std::function<std::vector<double>(const std::vector<TriedPose>&)>;

// What a way out is searched for: joints of a limb, over frames that follow each other.
struct LimbInTrouble {
  std::vector<Index> joints;
  int from, to;
  int worst;  // the frame in which the search begins
};

// Turns of a limb's joints that free it, tried out: joint by joint and axis by axis, up to `budget` radians. Other
// frames follow the worst one's way, as far as each must; where that is none, they look for their own. A frame that
// nothing frees has what is best. Of each frame: all joints' turns, `start` but for the limb's.
std::map<int, std::vector<Vec3>> find_way_out(const TurnedClip& clip, const LimbInTrouble& limb, double budget,
                                              const Turns& start, const JudgePoses& judge);

}  // namespace spherechain::baker
