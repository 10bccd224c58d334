// SPDX-License-Identifier: GPL-3.0-or-later
#include "fix/obstacle.h"

#include <algorithm>
#include <numbers>
#include <optional>
#include <utility>

namespace spherechain::baker {
namespace {

// Degrees: a joint that turns farther poses the limb anew, and its bend has lost its meaning.
constexpr double kBudgetMost = 90;

// The farthest that a joint turns, in degrees, where the limb's one frame becomes free within the budget.
std::optional<double> needed_turn(const TurnedClip& clip, const LimbInTrouble& limb, double budget_degrees,
                                  const JudgePoses& judge) {
  const double degree = std::numbers::pi / 180;
  const Turns still(static_cast<std::size_t>(clip.frames()) * clip.count(), Vec3::Zero());
  const std::vector<Vec3> turns = find_way_out(clip, limb, budget_degrees * degree, still, judge).at(limb.from);
  if (judge({{limb.from, turns}})[0] > 0) return {};
  double most = 0;
  for (const Vec3& turn : turns) most = std::max(most, turn.norm());
  return most / degree;
}

}  // namespace

Obstacle find_obstacle(const TurnedClip& clip, LimbInTrouble limb, int frame, double budget_degrees,
                       const JudgePoses& judge) {
  limb.from = limb.to = frame;
  limb.worst = {frame};
  // It could go out alone: what it shares its time with is in its way.
  if (needed_turn(clip, limb, budget_degrees, judge)) return {Outcome::kNoWayOut};
  for (const double budget : {2 * budget_degrees, kBudgetMost}) {
    if (budget <= budget_degrees) continue;
    const std::optional<double> needed = needed_turn(clip, limb, budget, judge);
    if (needed) return {Outcome::kOverBudget, *needed};
  }
  std::vector<TurningJoint> free = clip.joints();
  for (TurningJoint& joint : free) joint.hinge.reset();
  const TurnedClip without_limits(clip.rig(), clip.clip(), clip.fps(), clip.frames(), std::move(free));
  return {needed_turn(without_limits, limb, std::max(kBudgetMost, budget_degrees), judge) ? Outcome::kJointLimits
                                                                                          : Outcome::kNoWayOut};
}

}  // namespace spherechain::baker
