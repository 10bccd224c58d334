// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/take_back.h"

#include <algorithm>
#include <map>

#include "baker/fix/look.h"
#include "baker/fix/smoothing.h"
#include "baker/fix/time_windows.h"

namespace spherechain::baker {
namespace {

constexpr int kFadeOuts = 3;  // tries to fade out turns that made something worse, in ever wider windows

// By joint: 1 for each frame in which its turn fails.
using FailedTurns = std::map<Index, std::vector<char>>;

bool turns_in(const MendState& state, const WorkingEvent& event, Index joint) {
  const std::size_t count = state.facts.clip.count();
  for (int f = event.from(); f <= event.to(); ++f) {
    if (!state.turns[static_cast<std::size_t>(f) * count + joint].isZero(0)) return true;
  }
  return false;
}

// True if no event of the limb got better.
bool is_in_vain(const MendState& state, const LimbInTrouble& limb) {
  return std::all_of(limb.events.begin(), limb.events.end(),
                     [&](std::size_t e) { return state.goals.events[e].state == WorkingState::kGivenUp; });
}

// Turns fail if a part that they move got worse than before, or if they improved no event.
FailedTurns failed_turns(const MendState& state, const std::vector<PosePenetration>& found) {
  FailedTurns out;
  const auto fail = [&](Index joint, int from, int to) {
    std::vector<char>& frames = out.try_emplace(joint, state.in_window.size(), 0).first->second;
    for (int f = from; f <= to; ++f) frames[static_cast<std::size_t>(f)] = 1;
  };
  for (const PosePenetration& penetration : found) {
    if (!state.goals.is_worse(penetration)) continue;
    const int frame = static_cast<int>(penetration.frame);
    for (const std::uint32_t part : {penetration.found.part, penetration.found.other}) {
      for (const Index joint : state.facts.parts.above(part)) fail(joint, frame, frame);
    }
  }
  for (std::size_t e = 0; e < state.goals.events.size(); ++e) {
    const WorkingEvent& event = state.goals.events[e];
    if (event.state != WorkingState::kGivenUp || event.turn_degrees == 0) continue;
    const LimbInTrouble limb = limb_in_trouble(state.goals, state.facts.parts, e,
                                               [](const WorkingEvent& other) { return !other.is_left_alone(); });
    if (!is_in_vain(state, limb)) continue;
    for (const Index joint : limb.joints) {
      if (turns_in(state, event, joint)) fail(joint, event.from(), event.to());
    }
  }
  return out;
}

void fade_out_all(MendState& state, const FailedTurns& failed, double seconds) {
  for (const auto& [joint, frames] : failed) {
    fade_out(state.facts.clip, joint, frames, seconds, state.facts.loops, state.turns);
  }
}

bool is_marked_in(const std::vector<char>& frames, const std::vector<std::size_t>& run) {
  return std::any_of(run.begin(), run.end(), [&](std::size_t f) { return frames[f] != 0; });
}

// Removes failed turns from the whole run of frames.
void remove_all(MendState& state, const FailedTurns& failed) {
  const std::vector<std::vector<std::size_t>> runs = contiguous_runs(state.in_window, state.facts.loops);
  for (const auto& [joint, frames] : failed) {
    for (const std::vector<std::size_t>& run : runs) {
      if (!is_marked_in(frames, run)) continue;
      for (const std::size_t f : run) state.turns[f * state.facts.clip.count() + joint].setZero();
    }
  }
}

std::vector<PosePenetration> take_back_failed_turns(MendState& state) {
  for (int attempt = 1; attempt <= kFadeOuts + 1; ++attempt) {
    std::vector<PosePenetration> found = look_again(state);
    const FailedTurns failed = failed_turns(state, found);
    if (failed.empty()) return found;
    if (attempt <= kFadeOuts) {
      fade_out_all(state, failed, kWindowPad * attempt / kFadeOuts);
    } else {
      remove_all(state, failed);
    }
  }
  return look_again(state);
}

bool improves_in(const WorkingEvent& event, const std::vector<std::size_t>& run) {
  if (event.state != WorkingState::kFreed && event.state != WorkingState::kOpen) return false;
  const auto from = static_cast<std::size_t>(event.from()), to = static_cast<std::size_t>(event.to());
  return std::any_of(run.begin(), run.end(), [&](std::size_t f) { return f >= from && f <= to; });
}

// Removes the turns of each run of frames in which no event improved. Returns false if there were none.
bool take_back_useless_turns(MendState& state) {
  bool turned = false;
  const std::size_t count = state.facts.clip.count();
  for (const std::vector<std::size_t>& run : contiguous_runs(state.in_window, state.facts.loops)) {
    const auto improves = [&](const WorkingEvent& event) { return improves_in(event, run); };
    if (std::any_of(state.goals.events.begin(), state.goals.events.end(), improves)) continue;
    for (const std::size_t f : run) {
      for (std::size_t i = f * count; i < (f + 1) * count; ++i) {
        turned = turned || !state.turns[i].isZero(0);
        state.turns[i].setZero();
      }
    }
  }
  return turned;
}

}  // namespace

std::vector<PosePenetration> take_back_turns(MendState& state) {
  std::vector<PosePenetration> out = take_back_failed_turns(state);
  if (take_back_useless_turns(state)) out = look_again(state);
  return out;
}

}  // namespace spherechain::baker
