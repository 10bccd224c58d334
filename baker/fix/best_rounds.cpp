// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/best_rounds.h"

#include <cmath>
#include <vector>

#include "baker/fix/time_windows.h"

namespace spherechain::baker {
namespace {

// Residuals of a round, by frame.
std::vector<double> residuals_by_frame(const Goals& goals, const MeasuredRound& round) {
  std::vector<double> out(round.in_window.size(), 0);
  for (const PosePenetration& one : round.found) out[static_cast<std::size_t>(one.frame)] += goals.too_deep(one);
  return out;
}

}  // namespace

void take_best_rounds(MendState& state) {
  for (WorkingEvent& event : state.goals.events) {
    if (event.state == WorkingState::kGivenUp) event.state = WorkingState::kOpen;
  }
  std::vector<std::vector<double>> residuals;  // by round and frame
  for (const MeasuredRound& round : state.rounds) residuals.push_back(residuals_by_frame(state.goals, round));
  const std::size_t count = state.facts.clip.count();
  state.turns.assign(state.turns.size(), Vec3::Zero());
  for (const std::vector<std::size_t>& run : contiguous_runs(state.in_window, state.facts.loops)) {
    double least = HUGE_VAL;
    for (std::size_t r = 0; r < state.rounds.size(); ++r) {
      double sum = 0;
      for (const std::size_t f : run) sum += residuals[r][f];
      if (sum > least) continue;
      least = sum;
      for (const std::size_t f : run) {
        for (std::size_t i = f * count; i < (f + 1) * count; ++i) state.turns[i] = state.rounds[r].turns[i];
      }
    }
  }
}

}  // namespace spherechain::baker
