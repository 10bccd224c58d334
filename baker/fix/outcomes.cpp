// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/outcomes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "baker/fix/look.h"
#include "baker/fix/obstacle.h"

namespace spherechain::baker {
namespace {

// True if the event's parts did not penetrate in one of the rounds. If so, its turns were taken back later.
bool was_free_in(const std::vector<MeasuredRound>& rounds, const WorkingEvent& event) {
  const auto is_left = [&](const PosePenetration& one) {
    return is_fault(one.found.kind) && event.contains(place_of(one));
  };
  return std::any_of(rounds.begin(), rounds.end(), [&](const MeasuredRound& round) {
    const auto first = round.in_window.begin() + event.from(), end = round.in_window.begin() + event.to() + 1;
    return std::find(first, end, 0) == end && std::none_of(round.found.begin(), round.found.end(), is_left);
  });
}

// The reason why an event stayed about as deep.
Obstacle obstacle_of(MendState& state, std::size_t e) {
  const WorkingEvent& event = state.goals.events[e];
  const LimbInTrouble limb = limb_in_trouble(state.goals, state.facts.parts, e,
                                             [](const WorkingEvent& other) { return !other.is_left_alone(); });
  if (was_free_in(state.rounds, event) || limb.joints.empty()) return {MendOutcome::kNoWayOut};
  state.report(fmt::format("asking why frame {} is not free", event.deepest()));
  return find_obstacle(state.facts.clip, limb, event.deepest(), state.facts.options.budget_degrees,
                       residuals_of(state, limb));
}

// The outcome of an event that has no obstacle.
MendOutcome outcome_of(WorkingState state) {
  switch (state) {
    case WorkingState::kFreed:
      return MendOutcome::kCleared;
    case WorkingState::kFold:
      return MendOutcome::kFold;
    case WorkingState::kAccepted:
      return MendOutcome::kAccepted;
    case WorkingState::kOpen:
      return MendOutcome::kReduced;
    case WorkingState::kGivenUp:
      break;
  }
  return MendOutcome::kNoWayOut;
}

}  // namespace

const char* outcome_name(MendOutcome outcome) {
  static constexpr std::array<const char*, 8> kNames{"cleared",     "reduced",      "fold",       "accepted",
                                                     "over_budget", "joint_limits", "no_way_out", "refused"};
  return kNames[static_cast<std::size_t>(outcome)];
}

std::vector<MendedEvent> mended_events(MendState& state) {
  std::vector<MendedEvent> out;
  std::vector<std::size_t> given_up;
  for (WorkingEvent& event : state.goals.events) {
    out.push_back(
        {event.found, event.part, event.other, event.depth_after_mm, event.turn_degrees, outcome_of(event.state)});
    if (event.state == WorkingState::kGivenUp) given_up.push_back(out.size() - 1);
  }
  // While ways out are tried, all events that were given up have to become free.
  for (const std::size_t e : given_up) state.goals.events[e].state = WorkingState::kOpen;
  for (const std::size_t e : given_up) {
    const Obstacle obstacle = obstacle_of(state, e);
    out[e].outcome = obstacle.outcome;
    out[e].needed_degrees = obstacle.needed_degrees;
  }
  return out;
}

}  // namespace spherechain::baker
