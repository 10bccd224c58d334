// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/stuck_events.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <vector>

namespace spherechain::baker {
namespace {

constexpr int kPatience = 3;  // rounds without progress before an event counts as stuck

double sum_of_depths(const WorkingEvent& event, const std::vector<PosePenetration>& found) {
  double sum = 0;
  for (const PosePenetration& one : found) {
    if (is_fault(one.found.kind) && event.contains(place_of(one))) sum += double{one.found.measures.depth};
  }
  return sum;
}

std::vector<std::size_t> stuck_events(MendState& state, const std::vector<PosePenetration>& found, int round) {
  std::vector<std::size_t> out;
  for (std::size_t e = 0; e < state.goals.events.size(); ++e) {
    WorkingEvent& event = state.goals.events[e];
    if (!event.is_open()) continue;
    const double residual = sum_of_depths(event, found);
    if (round == 0) event.residual_at_start = residual;
    if (event.least.gets_better(residual, round) || residual == 0) continue;
    if (round - event.least.round >= kPatience) out.push_back(e);
  }
  return out;
}

// The limb's turns become lower bounds, and apply in the next step without a step limit.
void set_target_turns(MendState& state, const LimbInTrouble& limb, const std::map<int, std::vector<Vec3>>& by_frame) {
  for (const auto& [frame, turns] : by_frame) {
    for (const Index joint : limb.joints) {
      state.target_turns.erase({frame, joint});
      if (!turns[joint].isZero(0)) state.target_turns[{frame, joint}] = turns[joint];
    }
    state.jumps[static_cast<std::size_t>(frame)] = 1;
  }
}

// Searches target turns by trial for an event and all events that share its joints and frames. Returns false if no
// joint can turn.
bool search_way_out(MendState& state, std::size_t event, int round) {
  const TurnedClip& clip = state.facts.clip;
  const auto is_unsearched = [](const WorkingEvent& e) { return e.is_open() && !e.was_searched; };
  const LimbInTrouble limb = limb_in_trouble(state.goals, state.facts.parts, event, is_unsearched);
  state.goals.events[event].was_searched = true;
  if (limb.joints.empty()) return false;
  state.report(fmt::format("trying ways out of frames {} to {}", limb.from, limb.to));
  Turns start(state.turns.size(), Vec3::Zero());
  for (const auto& [at, turn] : state.target_turns) {
    start[static_cast<std::size_t>(at.first) * clip.count() + at.second] = turn;
  }
  set_target_turns(state, limb, find_way_out(clip, limb, state.budget, start, residuals_of(state, limb)));
  for (const std::size_t e : limb.events) {
    state.goals.events[e].least = {HUGE_VAL, round + 1};
    state.goals.events[e].was_searched = true;
  }
  state.separations.forget([&](const PenetrationKey& place) {
    const bool is_moved = limb.moves[place.part] != 0 || limb.moves[place.other] != 0;
    return is_moved && place.frame >= limb.from - 1 && place.frame <= limb.to + 1;
  });
  return true;
}

}  // namespace

bool makes_progress(MendState& state, const Look& look, int round) {
  const std::vector<std::size_t> stuck = stuck_events(state, look.found, round);
  state.least.gets_better(look.residual, round);
  for (const std::size_t e : stuck) {
    WorkingEvent& event = state.goals.events[e];
    if (!event.was_searched && search_way_out(state, e, round)) state.least = {HUGE_VAL, round + 1};
    const bool has_new_targets = event.least.round > round;
    if (has_new_targets || event.least.value < kReducedShare * event.residual_at_start) continue;
    event.state = WorkingState::kGivenUp;
    state.separations.forget([&](const PenetrationKey& place) { return event.contains(place); });
  }
  return round - state.least.round < 2 * kPatience;
}

bool reopen_events(MendState& state) {
  bool is_one = false;
  for (WorkingEvent& event : state.goals.events) {
    event.was_searched = false;
    event.least = {};
    if (event.state != WorkingState::kGivenUp) continue;
    event.state = WorkingState::kOpen;
    is_one = true;
  }
  return is_one;
}

}  // namespace spherechain::baker
