// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/fix/solve.h"
#include "baker/fix/turned_clip.h"

namespace spherechain::baker {

// A point whose steps from frame to frame are limited: a joint's place, or for a limb's last joint a point beyond it,
// about the middle of a hand.
struct EndPoint {
  Index joint;
  Vec3 own;  // in the joint's axes
};

// Places of all end points, one a turning joint, in the source clip and in the turned one.
class EndSteps {
 public:
  // Heights that an end may go further from one frame to the next than in the source clip; and the solver's target.
  // Skin that reaches further out than an end, as a report measures it, may go further.
  static constexpr double kStepMax = 0.01, kStepTarget = 0.009;

  EndSteps(const TurnedClip& clip, const Turns& turns, double height);

  const std::vector<EndPoint>& ends() const { return ends_; }
  Vec3 before(std::size_t end, int frame) const { return at(before_, end, frame); }
  Vec3 after(std::size_t end, int frame) const { return at(after_, end, frame); }
  // How much further an end goes from the frame before to this one than in the source clip, in heights.
  double extra(std::size_t end, int frame) const;
  // How far the ends that a joint moves are from their places in the source clip, at most, in heights.
  double moved(Index joint, int frame) const;

 private:
  Vec3 at(const std::vector<Vec3>& places, std::size_t end, int frame) const {
    return places[static_cast<std::size_t>(frame) * ends_.size() + end];
  }

  double height_;
  std::vector<std::vector<std::size_t>> below_;  // by joint: the ends that it moves
  std::vector<EndPoint> ends_;
  std::vector<Vec3> before_, after_;  // by frame, then by end
};

// Keeps ends that are near the limit from going further in a frame than they may. The constraints are linearised at
// `turns`.
void add_step_limits(const TurnedClip& clip, double height, const Turns& turns, std::vector<Constraint>& constraints);

}  // namespace spherechain::baker
