// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/obstacle.h"

#include <algorithm>
#include <numbers>
#include <optional>
#include <utility>

namespace spherechain::baker {
namespace {

// Degrees. Beyond this, a joint poses the limb anew, and the range of its bend has no meaning.
constexpr double kBudgetMax = 90;

// The largest turn of a joint, in degrees, that frees the limb's one frame. Empty if the budget is too small.
std::optional<double> needed_turn(const TurnedClip& clip, const LimbInTrouble& limb, double budget_degrees,
                                  const EvaluatePoses& evaluate) {
  const double degree = std::numbers::pi / 180;
  const Turns still(static_cast<std::size_t>(clip.frames()) * clip.count(), Vec3::Zero());
  const std::vector<Vec3> turns = find_way_out(clip, limb, budget_degrees * degree, still, evaluate).at(limb.from);
  if (evaluate({{limb.from, turns}})[0] > 0) return {};
  double most = 0;
  for (const Vec3& turn : turns) most = std::max(most, turn.norm());
  return most / degree;
}

}  // namespace

Obstacle find_obstacle(const TurnedClip& clip, LimbInTrouble limb, int frame, double budget_degrees,
                       const EvaluatePoses& evaluate) {
  limb.from = limb.to = frame;
  limb.worst = {frame};
  // The frame alone can be freed, so an event at the same time prevents it.
  if (needed_turn(clip, limb, budget_degrees, evaluate)) return {MendOutcome::kNoWayOut};
  for (const double budget : {2 * budget_degrees, kBudgetMax}) {
    if (budget <= budget_degrees) continue;
    const std::optional<double> needed = needed_turn(clip, limb, budget, evaluate);
    if (needed) return {MendOutcome::kOverBudget, *needed};
  }
  std::vector<TurningJoint> free = clip.joints();
  for (TurningJoint& joint : free) joint.hinge.reset();
  const TurnedClip without_limits(clip.rig(), clip.clip(), clip.fps(), clip.frames(), std::move(free));
  return {needed_turn(without_limits, limb, std::max(kBudgetMax, budget_degrees), evaluate) ? MendOutcome::kJointLimits
                                                                                            : MendOutcome::kNoWayOut};
}

}  // namespace spherechain::baker
