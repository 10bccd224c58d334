// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/fix/mend.h"
#include "baker/fix/part_joints.h"

namespace spherechain::baker {

// The reason why a limb stays in a penetration: kOverBudget, kJointLimits or kNoWayOut.
struct Obstacle {
  MendOutcome outcome;
  double needed_degrees = 0;  // for kOverBudget: the budget that would free the frame
};

// Searches ways out for the limb in this frame alone: within the budget, with larger budgets, then without hinges.
Obstacle find_obstacle(const TurnedClip& clip, LimbInTrouble limb, int frame, double budget_degrees,
                       const EvaluatePoses& evaluate);

}  // namespace spherechain::baker
