// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <vector>

#include "baker/fix/turned_clip.h"

namespace spherechain::baker {

struct LimbInTrouble;

// A candidate pose: a frame with other turns.
struct TriedPose {
  int frame;
  std::vector<Vec3> turns;  // by joint
};

// Returns the residual penetration of each pose, in heights. 0: free.
using EvaluatePoses = std::function<std::vector<double>(const std::vector<TriedPose>&)>;

// Searches turns of a limb's joints that free it, up to `budget` radians: joint by joint and axis by axis, in the worst
// frames. Each other frame scales one of these candidates as little as it can. The choice over all frames has the least
// cost and change. A frame that no candidate frees takes its best one. Returns the turns of all joints by frame; joints
// outside of the limb keep `start`.
std::map<int, std::vector<Vec3>> find_way_out(const TurnedClip& clip, const LimbInTrouble& limb, double budget,
                                              const Turns& start, const EvaluatePoses& evaluate);

}  // namespace spherechain::baker
