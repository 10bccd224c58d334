// SPDX-License-Identifier: GPL-3.0-or-later
// Gauss-Newton over a whole clip. Each penetration of two body parts in a frame adds a constraint: their deepest points
// separate along the way out. Constraints of earlier rounds stay, so that separated parts do not come back. If an event
// gets no better, a search by trial gives its limb target turns.
#include "baker/fix/mend.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "baker/fix/best_rounds.h"
#include "baker/fix/gauss_newton.h"
#include "baker/fix/look.h"
#include "baker/fix/mend_result.h"
#include "baker/fix/mend_state.h"
#include "baker/fix/outcomes.h"
#include "baker/fix/smoothing.h"
#include "baker/fix/stuck_events.h"
#include "baker/fix/take_back.h"
#include "baker/fix/time_windows.h"

namespace spherechain::baker {
namespace {

constexpr int kRoundsMax = 24;                // within a budget
constexpr double kFirstBudget = 25;           // degrees
constexpr int kFreeRoundsMax = 4;             // rounds without faults in which joints return as far as they can
constexpr double kStillStep = to_radians(1);  // a round with smaller steps may be the last
constexpr int kSettleRounds = 3;              // after smoothing
constexpr int kSettleWeight = 3;              // a settling round weighs separations as this round of the search

// Separates body parts round by round, until all are apart and the joints are at rest, or nothing gets better any more.
// Returns the number of the next round.
int separate_parts(MendState& state, int first) {
  double step = 0;  // largest turn of a joint in the last round
  bool was_free = false;
  int free_rounds = 0, round = first;
  for (; round < first + kRoundsMax && (state.goals.has_open_events() || step > kStillStep); ++round) {
    const Look look = look_in_round(state, round, round == first);
    state.report(fmt::format("round {}: {:.1f} mm too deep in all", round + 1, look.residual * state.facts.mm));
    const bool is_free = look.residual == 0;
    if (is_free && was_free && step < kStillStep && !has_deep_contacts(state, look.found)) break;
    if (is_free || free_rounds > 0) {
      if (round > first && ++free_rounds > kFreeRoundsMax) break;
    } else if (!makes_progress(state, look, round)) {
      break;
    }
    step = gauss_newton_step(state, round, is_free);
    was_free = is_free;
  }
  return round;
}

// Small turns first: events that they do not free are tried again with larger ones.
int separate_within_budgets(MendState& state) {
  const double most = to_radians(state.facts.options.budget_degrees);
  int rounds = 0;
  for (double budget = to_radians(kFirstBudget); state.goals.has_open_events(); budget *= 2) {
    state.budget = std::min(budget, most);
    rounds = separate_parts(state, rounds);
    const bool is_left = reopen_events(state) || state.least.value > 0;
    state.least = {};
    if (state.budget == most || !is_left) break;
  }
  return rounds;
}

void open_windows_of_turns(MendState& state) {
  std::set<int> turned;
  for (std::size_t i = 0; i < state.turns.size(); ++i) {
    if (!state.turns[i].isZero(0)) turned.insert(static_cast<int>(i / state.facts.clip.count()));
  }
  state.in_window = windows_around(turned, state.facts.clip, state.facts.loops);
}

// Smoothing moves parts into each other again. A few more rounds part them, and smoothing has less to do then.
void settle(MendState& state) {
  for (int round = 0; round < kSettleRounds; ++round) {
    const double residual = separate_everywhere(state);
    state.report(fmt::format("settling: {:.1f} mm too deep in all", residual * state.facts.mm));
    if (residual == 0) return;
    gauss_newton_step(state, kSettleWeight, false);
  }
  calm_turns(state.facts.clip, state.facts.height, state.facts.loops, state.turns);
}

// Takes back turns that make something worse: of the turns as they are and, while faults are left, of settled ones.
// Settling can harm, too: the turns that leave least are kept.
void take_back_or_settle(MendState& state) {
  const Turns start = state.turns;
  const std::vector<WorkingEvent> events = state.goals.events;
  Turns best;
  double least = HUGE_VAL;
  for (const bool settles : {false, true}) {
    state.turns = start;
    state.goals.events = events;
    if (settles) settle(state);
    open_windows_of_turns(state);
    take_back_turns(state);
    double left = 0;
    for (const PosePenetration& one : look_again(state)) left += double{one.found.fault_depth};
    if (left < least) best = state.turns;
    least = std::min(left, least);
    const auto is_done = [](const WorkingEvent& e) { return e.state == WorkingState::kFreed || e.is_left_alone(); };
    if (std::all_of(state.goals.events.begin(), state.goals.events.end(), is_done)) break;
  }
  state.turns = std::move(best);
  open_windows_of_turns(state);
}

}  // namespace

Mend mend_clip(const ClipFacts& facts, const std::function<bool(const Event&)>& leave,
               const std::function<void(const std::string&)>& report) {
  MendState state = first_look(facts, leave, report);
  const int rounds = separate_within_budgets(state);
  take_best_rounds(state);
  calm_turns(facts.clip, facts.height, facts.loops, state.turns);
  state.finder.leave_out({});  // corrections must not add faults of pairs that were harmless
  take_back_or_settle(state);
  const std::vector<PosePenetration> after = look_as_check(state);
  state.finder.leave_out(state.goals.harmless());
  std::vector<MendedEvent> events = mended_events(state);
  Mend out = compared_result(state, after);
  out.events = std::move(events);
  out.rounds = rounds;
  return out;
}

}  // namespace spherechain::baker
