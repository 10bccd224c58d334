// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/mend_result.h"

#include <cmath>

namespace spherechain::baker {
namespace {

constexpr double kNearMax = 5;  // mm: largest distance of Mend::still_near

// Common volume of two parts of a selected event in a whole frame, in cm3.
double volume_of(MendState& state, double frame, const Penetration& found, const Turns& turns) {
  const WorkingEvent* event = state.goals.event_at({frame, found.part, found.other});
  if (event == nullptr || event->is_left_alone() || frame != std::floor(frame)) return 0;
  return state.finder.volume(frame, found, turns) * std::pow(state.facts.mm / 10, 3);
}

// True if a fault that was shallow before has been separated in this place.
bool is_separated_shallow(const MendState& state, const PenetrationKey& place, const Penetration& before) {
  const auto separations = state.separations.all().find(place);
  if (separations == state.separations.all().end() || separations->second.empty()) return false;
  return is_fault(before.kind) && state.facts.mm * double{before.measures.depth} <= kShallowMax;
}

double distance_after_mm(const MendState& state, const PenetrationKey& place) {
  const Deformation pose = state.facts.clip.pose(place.frame, state.turns).deformation;
  return state.facts.mm * distance_between(state.facts.animated, pose, place.part, place.other);
}

}  // namespace

Mend compared_result(MendState& state, const std::vector<PosePenetration>& after) {
  const ClipFacts& facts = state.facts;
  Mend out;
  out.joints = facts.clip.joints();
  out.turns = state.turns;
  out.in_window = state.in_window;
  out.compared = compare(facts.clip, state.turns, facts.feet, facts.wrists, facts.mm);
  for (const PosePenetration& one : after) out.volume_after += volume_of(state, one.frame, one.found, state.turns);
  const Turns none(state.turns.size(), Vec3::Zero());
  for (const auto& [place, before] : state.goals.before()) {
    out.volume_before += volume_of(state, place.frame, before, none);
    if (!is_separated_shallow(state, place, before)) continue;
    ++out.shallow;
    out.still_near += distance_after_mm(state, place) <= kNearMax ? 1 : 0;
  }
  return out;
}

}  // namespace spherechain::baker
