// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/take_back.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "baker/events/join_events.h"
#include "baker/fix/look.h"
#include "baker/fix/smoothing.h"
#include "baker/fix/step_limit.h"
#include "baker/fix/time_windows.h"

namespace spherechain::baker {
namespace {

constexpr int kHalfTries = 2;    // tries to halve the turns that made something worse; later ones take them away
constexpr int kNarrowTries = 5;  // tries that fade as fast as the step limit allows
constexpr int kTries = 10;       // in all; those after the narrow ones fade ever more slowly
constexpr double kFootMoves = 1e-3, kFootTurns = 5e-3;  // heights; a share of the axes' size
constexpr double kWorth = 3;                            // times the depth that is added: so much less is worth it
constexpr double kFadeSeconds = 0.3;                    // the shortest fade
constexpr double kWidest = 3;                           // the last try's fade, times that of a narrow one

// Sums of the fault depths of parts that are moved, by frame.
struct Depths {
  std::vector<double> before, after;
};

Depths depths_of(const MendState& state, const std::vector<char>& moves, const std::vector<PosePenetration>& found) {
  Depths out{std::vector<double>(state.in_window.size(), 0), std::vector<double>(state.in_window.size(), 0)};
  const auto add = [&](const PenetrationKey& place, const Penetration& of, std::vector<double>& to) {
    if (moves[place.part] == 0 && moves[place.other] == 0) return;
    to[static_cast<std::size_t>(place.frame)] += double{of.fault_depth};
  };
  for (const auto& [place, of] : state.goals.before()) add(place, of, out.before);
  for (const PosePenetration& one : found) {
    if (!is_between(one.frame)) add(place_of(one), one.found, out.after);
  }
  return out;
}

void mark(MarkedTurns& failed, Index joint, std::size_t frame, std::size_t frames) {
  failed.try_emplace(joint, frames, 0).first->second[frame] = 1;
}

bool is_any_turned(const MendState& state, const std::set<Index>& joints, double frame) {
  const std::vector<Vec3> turns = state.facts.clip.turns_at(frame, state.turns);
  return std::any_of(joints.begin(), joints.end(), [&](Index joint) { return !turns[joint].isZero(0); });
}

// Turns fail if a part that they move got worse than before, unless the parts that they move got far better in all.
// Faults between frames where nothing turns are the source's own.
void add_worse(const MendState& state, const std::vector<PosePenetration>& found, MarkedTurns& failed) {
  for (const PosePenetration& one : found) {
    const double by = state.goals.worse_by(one);
    if (by == 0) continue;
    const std::set<Index> joints = state.facts.parts.parting(one.found.part, one.found.other, HUGE_VAL);
    if (!is_any_turned(state, joints, one.frame)) continue;
    const Depths depths = depths_of(state, state.facts.parts.moved_by(joints), found);
    const auto frame = static_cast<std::size_t>(one.frame);
    if (depths.before[frame] - depths.after[frame] > kWorth * by) continue;
    for (const Index joint : joints) {
      mark(failed, joint, frame, state.in_window.size());
      mark(failed, joint, static_cast<std::size_t>(std::ceil(one.frame)), state.in_window.size());
    }
  }
}

// Turns fail if around a frame they make their limb's faults hardly better.
void add_vain(const MendState& state, const std::vector<PosePenetration>& found, MarkedTurns& failed) {
  const auto pad = static_cast<std::size_t>(std::ceil(kWindowPad * state.facts.clip.fps()));
  const std::size_t frames = state.in_window.size();
  for (std::size_t e = 0; e < state.goals.events.size(); ++e) {
    const WorkingEvent& event = state.goals.events[e];
    if (event.is_left_alone() || event.state == WorkingState::kFreed || event.turn_degrees == 0) continue;
    const LimbInTrouble limb = limb_in_trouble(state.goals, state.facts.parts, e,
                                               [](const WorkingEvent& other) { return !other.is_left_alone(); });
    const Depths depths = depths_of(state, limb.moves, found);
    for (auto f = static_cast<std::size_t>(event.from()); f <= static_cast<std::size_t>(event.to()); ++f) {
      double before = 0, after = 0;
      for (std::size_t g = f - std::min(f, pad); g <= std::min(f + pad, frames - 1); ++g) {
        before += depths.before[g];
        after += depths.after[g];
      }
      for (const Index joint : limb.joints) {
        const bool is_turned = !state.turns[f * state.facts.clip.count() + joint].isZero(0);
        if (is_turned && after >= kReducedShare * before) mark(failed, joint, f, frames);
      }
    }
  }
}

// Turns fail if a foot does not keep its place and direction.
void add_moved_feet(const MendState& state, MarkedTurns& failed) {
  const TurnedClip& clip = state.facts.clip;
  const Turns none(state.turns.size(), Vec3::Zero());
  for (const int f : marked_frames(state.in_window)) {
    const TurnedClip::Pose before = clip.pose(f, none), after = clip.pose(f, state.turns);
    for (const Index foot : state.facts.feet) {
      const Affine &a = before.axes[foot], &b = after.axes[foot];
      const bool is_moved = (a.translation() - b.translation()).norm() > kFootMoves * state.facts.height ||
                            (a.linear() - b.linear()).norm() > kFootTurns * a.linear().norm();
      if (!is_moved) continue;
      for (const Index joint : clip.above_joint(foot)) {
        mark(failed, joint, static_cast<std::size_t>(f), state.in_window.size());
      }
    }
  }
}

// Turns fail if they make an end go further in a frame than it may.
void add_long_steps(const MendState& state, const EndSteps& steps, MarkedTurns& failed) {
  for (int f = 1; f < state.facts.clip.frames(); ++f) {
    for (std::size_t e = 0; e < steps.ends().size(); ++e) {
      if (steps.extra(e, f) <= EndSteps::kStepMax) continue;
      for (const Index joint : state.facts.clip.above_joint(steps.ends()[e].joint)) {
        mark(failed, joint, static_cast<std::size_t>(f) - 1, state.in_window.size());
        mark(failed, joint, static_cast<std::size_t>(f), state.in_window.size());
      }
    }
  }
}

// Removes failed turns from the whole run of frames.
void remove_all(MendState& state, const MarkedTurns& failed) {
  const std::vector<std::vector<std::size_t>> runs = contiguous_runs(state.in_window, state.facts.loops);
  for (const auto& [joint, frames] : failed) {
    for (const std::vector<std::size_t>& run : runs) {
      if (std::none_of(run.begin(), run.end(), [&](std::size_t f) { return frames[f] != 0; })) continue;
      for (const std::size_t f : run) state.turns[f * state.facts.clip.count() + joint].setZero();
    }
  }
}

// Seconds in which the ends that a joint moves can return to the source clip from where they are near the marked
// frames.
double seconds_to_return(const MendState& state, const EndSteps& steps, Index joint, const std::vector<char>& marked) {
  constexpr double kSteepest = 1.5;  // of a smooth fade, times its mean slope
  double farthest = 0;
  const int reach = static_cast<int>(kWidest * kFadeSeconds * state.facts.clip.fps());
  for (const int f : marked_frames(marked)) {
    for (int g = std::max(0, f - reach); g <= std::min(f + reach, state.facts.clip.frames() - 1); ++g) {
      farthest = std::max(farthest, steps.moved(joint, g));
    }
  }
  return kSteepest * farthest / (EndSteps::kStepTarget * state.facts.clip.fps());
}

void take_back_failed_turns(MendState& state) {
  for (int attempt = 1; attempt <= kTries; ++attempt) {
    const std::vector<PosePenetration> found = look_again(state);
    MarkedTurns failed;
    add_worse(state, found, failed);
    add_moved_feet(state, failed);
    const EndSteps steps(state.facts.clip, state.turns, state.facts.height);
    if (attempt > kHalfTries) add_long_steps(state, steps, failed);
    if (attempt > kHalfTries && attempt < kTries) add_vain(state, found, failed);
    if (failed.empty() && attempt > kHalfTries) return;
    if (attempt == kTries) return remove_all(state, failed);
    state.report(fmt::format("taking back what makes it worse, {} of {}", attempt, kTries));
    const double wider = std::pow(kWidest, std::max(0, attempt - kNarrowTries) / double{kTries - kNarrowTries}),
                 least = attempt <= kHalfTries ? 0.5 : 0;
    for (const auto& [joint, frames] : failed) {
      const double seconds = std::max(kFadeSeconds, (1 - least) * seconds_to_return(state, steps, joint, frames));
      fade_out(state.facts.clip, joint, frames, wider * seconds, least, state.facts.loops, state.turns);
    }
  }
}

bool improves_in(const WorkingEvent& event, const std::vector<std::size_t>& run) {
  if (event.state != WorkingState::kFreed && event.state != WorkingState::kOpen) return false;
  const auto from = static_cast<std::size_t>(event.from()), to = static_cast<std::size_t>(event.to());
  return std::any_of(run.begin(), run.end(), [&](std::size_t f) { return f >= from && f <= to; });
}

// Removes the turns of each run of frames in which no event improved.
void take_back_useless_turns(MendState& state) {
  const std::size_t count = state.facts.clip.count();
  for (const std::vector<std::size_t>& run : contiguous_runs(state.in_window, state.facts.loops)) {
    const auto improves = [&](const WorkingEvent& event) { return improves_in(event, run); };
    if (std::any_of(state.goals.events.begin(), state.goals.events.end(), improves)) continue;
    for (const std::size_t f : run) {
      for (std::size_t i = f * count; i < (f + 1) * count; ++i) state.turns[i].setZero();
    }
  }
}

}  // namespace

void take_back_turns(MendState& state) {
  take_back_failed_turns(state);
  (void)look_again(state);
  take_back_useless_turns(state);
}

}  // namespace spherechain::baker
