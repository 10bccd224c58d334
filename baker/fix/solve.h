// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "fix/turned_clip.h"

namespace spherechain::baker {

// A wish of one number: sum of parts . turns comes to `value`. Turns are those of whole frames.
struct Wish {
  struct Part {
    int frame;
    Index joint;
    Vec3 by;
  };
  std::vector<Part> parts;
  double value = 0;
  double weight = 1;       // of its squared miss
  double weight_over = 0;  // the same, where the sum is more than `value`
};

// The turns of a clip's frames that cost least: their price, how unsteady they are, and what is missed of the wishes.
// Frames outside of `in_window` keep zero. One linear system over all of the clip. To leave `start` costs `leave` times
// a radian's square where a wish names the turn: wishes hold near it alone.
Turns solve_turns(const TurnedClip& clip, const std::vector<char>& in_window, const std::vector<Wish>& wishes,
                  const Turns& start, double leave);

}  // namespace spherechain::baker
