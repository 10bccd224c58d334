// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/look.h"

#include <algorithm>
#include <set>

#include "baker/events/join_events.h"
#include "baker/fix/time_windows.h"

namespace spherechain::baker {
namespace {

constexpr int kLookBetween = 4;  // rounds from one check between frames to the next, while frames have faults

std::vector<double> all_frames(const TurnedClip& clip) {
  std::vector<double> out;
  for (int f = 0; f < clip.frames(); ++f) out.push_back(f);
  return out;
}

// Frames in windows, and times between frames that have separations. In the first round of a budget, all frames.
std::vector<double> frames_to_measure(const MendState& state, bool is_first) {
  if (is_first) return all_frames(state.facts.clip);
  std::set<double> out;
  for (const int f : marked_frames(state.in_window)) out.insert(f);
  for (const auto& [place, separations] : state.separations.all()) out.insert(place.frame);
  return {out.begin(), out.end()};
}

// Adds separations for penetrations that are too deep. Returns the sum of their residuals.
double add_separations(MendState& state, const std::vector<PosePenetration>& found) {
  double sum = 0;
  for (const PosePenetration& penetration : found) {
    if (state.goals.is_let_be(penetration)) continue;
    sum += state.goals.too_deep(penetration);
    const PenetrationKey place = place_of(penetration);
    const Penetration* before = state.goals.before(place);
    const bool is_shallow = before != nullptr && state.facts.mm * double{before->measures.depth} <= kShallowMax;
    state.separations.add(place, penetration.found, state.goals.allowed(penetration), is_shallow, state.turns);
  }
  return sum;
}

void append(const std::vector<PosePenetration>& more, std::vector<PosePenetration>& to) {
  to.insert(to.end(), more.begin(), more.end());
}

// Measures all frames, and between frames that may have changed.
std::vector<PosePenetration> measure(MendState& state) {
  std::vector<PosePenetration> out = state.finder.in_frames(all_frames(state.facts.clip), state.turns);
  append(state.finder.between(marked_frames(state.in_window), state.turns), out);
  return out;
}

double greatest_turn(const MendState& state, const WorkingEvent& event) {
  double most = 0;
  const std::size_t count = state.facts.clip.count();
  const std::size_t begin = static_cast<std::size_t>(event.from()) * count,
                    end = static_cast<std::size_t>(event.to() + 1) * count;
  for (std::size_t i = begin; i < end; ++i) most = std::max(most, state.turns[i].norm());
  return most;
}

void classify(const MendState& state, const std::vector<PosePenetration>& found, WorkingEvent& event) {
  event.depth_after_mm = event.depths_after = 0;
  for (const PosePenetration& penetration : found) {
    if (!event.contains(place_of(penetration)) || !is_fault(penetration.found.kind)) continue;
    const double depth = state.facts.mm * double{penetration.found.measures.depth};
    event.depth_after_mm = std::max(event.depth_after_mm, depth);
    event.depths_after += is_between(penetration.frame) ? 0 : depth;
  }
  event.turn_degrees = to_degrees(greatest_turn(state, event));
  if (event.is_left_alone()) return;
  const bool is_reduced = event.depth_after_mm < kReducedShare * event.found.depth_mm ||
                          event.depths_after < kReducedShare * event.depths_before;
  event.state = event.depth_after_mm == 0 ? WorkingState::kFreed
                : is_reduced              ? WorkingState::kOpen
                                          : WorkingState::kGivenUp;
}

}  // namespace

MendState first_look(const ClipFacts& facts, const std::function<bool(const Event&)>& leave,
                     const std::function<void(const std::string&)>& report) {
  const TurnedClip& clip = facts.clip;
  const auto frames = static_cast<std::size_t>(clip.frames());
  const Turns none(frames * clip.count(), Vec3::Zero());
  report("looking");
  FaultFinder finder(facts.animated, clip);
  const std::vector<PosePenetration> found = finder.in_frames(all_frames(clip), none);
  const BodyParts parts = body_parts_of(facts.animated.asset());
  Goals goals = goals_of(found, finder.in_sequence(none), clip.frames(), parts.parts, facts.mm, facts.options, leave);
  finder.leave_out(goals.harmless());
  return {facts,
          report,
          std::move(finder),
          std::move(goals),
          Separations(facts.animated, clip,
                      [&facts](std::uint32_t a, std::uint32_t b) { return facts.parts.parting(a, b); }),
          0,
          none,
          {},
          std::vector<char>(frames, 0),
          std::vector<char>(frames, 0),
          {},
          {}};
}

Look look_in_round(MendState& state, int round, bool is_first) {
  Look out;
  out.found = state.finder.in_frames(frames_to_measure(state, is_first), state.turns);
  out.residual = add_separations(state, out.found);
  const bool is_due = out.residual == 0 || round % kLookBetween == kLookBetween - 1;
  if (round == 0 || !is_due) return out;
  const std::vector<PosePenetration> between = state.finder.between(marked_frames(state.in_window), state.turns);
  out.residual += add_separations(state, between);
  append(between, out.found);
  state.rounds.push_back({state.turns, out.found, state.in_window});
  return out;
}

double separate_everywhere(MendState& state) { return add_separations(state, measure(state)); }

bool has_deep_contacts(const MendState& state, const std::vector<PosePenetration>& found) {
  return std::any_of(found.begin(), found.end(), [&](const PosePenetration& penetration) {
    const double depth_mm = state.facts.mm * double{penetration.found.measures.depth};
    return depth_mm > state.facts.options.margin_mm && !state.goals.is_let_be(penetration);
  });
}

std::vector<PosePenetration> look_again(MendState& state) {
  std::vector<PosePenetration> out = measure(state);
  for (WorkingEvent& event : state.goals.events) classify(state, out, event);
  return out;
}

std::vector<PosePenetration> look_as_check(MendState& state) {
  std::vector<PosePenetration> out = state.finder.in_sequence(state.turns);
  append(state.finder.between(marked_frames(state.in_window), state.turns), out);
  for (WorkingEvent& event : state.goals.events) classify(state, out, event);
  return out;
}

EvaluatePoses residuals_of(MendState& state, const LimbInTrouble& limb) {
  return [&](const std::vector<TriedPose>& poses) {
    std::vector<double> out;  // in heights
    for (const std::vector<PosePenetration>& found : state.finder.in_poses(poses, limb.moves)) {
      out.push_back(0);
      for (const PosePenetration& penetration : found) {
        out.back() += state.goals.too_deep(penetration) / state.facts.height;
      }
    }
    return out;
  };
}

}  // namespace spherechain::baker
