// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/fix/turned_clip.h"

namespace spherechain::baker {

// A linear equation in the turns of whole frames: sum of coefficients . turns = target, in the least-squares sense.
struct Constraint {
  struct Term {
    int frame;
    Index joint;
    Vec3 by;
  };
  std::vector<Term> terms;
  double target = 0;
  double weight = 1;        // of its squared residual
  double weight_above = 0;  // the same, if the sum exceeds the target
};

// Solves for the turns with the least sum of their costs, their unsteadiness over time, and the constraints' weighted
// squared residuals: one sparse linear system over the clip. Frames outside of `in_window` keep zero. Turns that a
// constraint names also pay `leave` per squared radian away from `start`, because constraints are linearised there.
Turns solve_turns(const TurnedClip& clip, const std::vector<char>& in_window,
                  const std::vector<Constraint>& constraints, const Turns& start, double leave);

}  // namespace spherechain::baker
