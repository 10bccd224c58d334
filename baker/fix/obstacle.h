// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "fix/mend.h"
#include "fix/part_joints.h"

namespace spherechain::baker {

// Why a limb was not freed: kOverBudget, kJointLimits or kNoWayOut.
struct Obstacle {
  Outcome outcome;
  double needed_degrees = 0;  // of kOverBudget: the budget that frees the frame
};

// Tries the limb out in this one frame, first within the budget, then with more and more freedom.
Obstacle find_obstacle(const TurnedClip& clip, LimbInTrouble limb, int frame, double budget_degrees,
                       const JudgePoses& judge);

}  // namespace spherechain::baker
