// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/gauss_newton.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "baker/fix/constraints.h"
#include "baker/fix/solve.h"
#include "baker/fix/step_limit.h"
#include "baker/fix/time_windows.h"

namespace spherechain::baker {
namespace {

constexpr double kStepLimit = to_radians(10);  // of a joint in a round
constexpr double kNearStart = 3;  // cost of leaving the turns at the start of a round, while there is a fault
constexpr double kTie = 1e7;      // weight that keeps a loop's ends equal
constexpr double kNearBudget = 0.7, kBudgetWeight = 1e6;               // of a residual of one radian
constexpr double kSeparationWeight = 1e4, kSeparationWeightMax = 1e5;  // it doubles each round

void open_windows(MendState& state) {
  std::set<int> frames;
  for (const auto& [place, separations] : state.separations.all()) frames.insert(static_cast<int>(place.frame));
  for (const auto& [at, turn] : state.target_turns) frames.insert(at.first);
  state.in_window = windows_around(frames, state.facts.clip, state.facts.loops);
}

// The turns of the first and of the last frame must be equal.
void add_loop_constraints(const TurnedClip& clip, std::vector<Constraint>& constraints) {
  for (Index j = 0; j < clip.count(); ++j) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 axis = Vec3::Unit(k);
      constraints.push_back({{{0, j, axis}, {clip.frames() - 1, j, -axis}}, 0, kTie, kTie});
    }
  }
}

// Turns near the budget must not leave it. If they were only cut after each round, frames nearby would know nothing of
// it and turn elsewhere.
void add_budget_limits(const MendState& state, std::vector<Constraint>& constraints) {
  const std::size_t count = state.facts.clip.count();
  for (std::size_t i = 0; i < state.turns.size(); ++i) {
    const Vec3& turn = state.turns[i];
    if (turn.norm() < kNearBudget * state.budget) continue;
    const auto frame = static_cast<int>(i / count);
    constraints.push_back(
        {{{frame, static_cast<Index>(i % count), turn.normalized()}}, state.budget, 0, kBudgetWeight});
  }
}

std::vector<Constraint> constraints_of(const MendState& state, double weight) {
  const ClipFacts& facts = state.facts;
  std::vector<Constraint> out;
  state.separations.add_constraints(weight, state.turns, out);
  for (const auto& [at, turn] : state.target_turns) {
    out.push_back({{{at.first, at.second, turn.normalized()}}, turn.norm(), weight, 0});
  }
  if (facts.loops) add_loop_constraints(facts.clip, out);
  add_budget_limits(state, out);
  add_step_limits(facts.clip, facts.height, state.turns, out);
  for (const int f : marked_frames(state.in_window)) {
    const auto frame = static_cast<std::size_t>(f);
    add_pinned_joints(facts.clip, facts.feet, f, facts.height, state.turns, out);
    add_pinned_joints(facts.clip, facts.planted[frame], f, facts.height, state.turns, out);
    if (facts.hands_joined[frame] != 0) {
      add_hand_constraint(facts.clip, facts.wrists[0], facts.wrists[1], f, facts.height, state.turns, out);
    }
    add_hinge_limits(facts.clip, facts.feet, f, out);
  }
  return out;
}

// Moves the turns towards `target`. The step limit does not apply in frames with new target turns.
double limited_step(const Turns& target, MendState& state) {
  const TurnedClip& clip = state.facts.clip;
  double farthest = 0;
  for (std::size_t i = 0; i < state.turns.size(); ++i) {
    const std::size_t frame = i / clip.count();
    Vec3& turn = state.turns[i];
    Vec3 step = target[i] - turn;
    if (step.norm() > kStepLimit && state.jumps[frame] == 0) step *= kStepLimit / step.norm();
    const Vec3 to =
        clip.within_limits(static_cast<int>(frame), static_cast<Index>(i % clip.count()), turn + step, state.budget);
    farthest = std::max(farthest, (to - turn).norm());
    turn = to;
  }
  state.jumps.assign(state.jumps.size(), 0);
  return farthest;
}

}  // namespace

double gauss_newton_step(MendState& state, int round, bool is_free) {
  open_windows(state);
  const double weight = std::min(kSeparationWeight * std::pow(2, round), kSeparationWeightMax);
  const Turns target = solve_turns(state.facts.clip, state.in_window, constraints_of(state, weight), state.turns,
                                   is_free ? 0 : kNearStart);
  return limited_step(target, state);
}

}  // namespace spherechain::baker
