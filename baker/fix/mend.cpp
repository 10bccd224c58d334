// SPDX-License-Identifier: GPL-3.0-or-later
// Gauss-Newton over a whole clip. Each penetration of two body parts in a frame adds a constraint: their deepest points
// separate along the way out. Constraints of earlier rounds stay, so that separated parts do not come back. If an event
// gets no better, a search by trial gives its limb target turns.
#include "baker/fix/mend.h"

#include <fmt/format.h>

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

constexpr int kRoundsMax = 24;
constexpr int kFreeRoundsMax = 4;             // rounds without faults in which joints return as far as they can
constexpr double kStillStep = to_radians(1);  // a round with smaller steps may be the last

// Separates body parts round by round, until all are apart and the joints are at rest, or nothing gets better any more.
// Returns the number of rounds.
int separate_parts(MendState& state) {
  double step = 0;  // largest turn of a joint in the last round
  bool was_free = false;
  int free_rounds = 0, round = 0;
  for (; round < kRoundsMax && (state.goals.has_open_events() || step > kStillStep); ++round) {
    const Look look = look_in_round(state, round);
    state.report(fmt::format("round {}: {:.1f} mm too deep", round + 1, look.residual * state.facts.mm));
    const bool is_free = look.residual == 0;
    if (is_free && was_free && step < kStillStep && !has_deep_contacts(state, look.found)) break;
    if (is_free || free_rounds > 0) {
      if (round > 0 && ++free_rounds > kFreeRoundsMax) break;
    } else if (!makes_progress(state, look, round)) {
      break;
    }
    step = gauss_newton_step(state, round, is_free);
    was_free = is_free;
  }
  return round;
}

}  // namespace

Mend mend_clip(const AnimatedAsset& animated, const Roles& roles, const ClipFrames& clip, const MendOptions& options,
               const std::function<bool(const Event&)>& leave, const std::function<void(const std::string&)>& report) {
  const ClipFacts facts = clip_facts(animated, roles, clip, options);
  MendState state = first_look(facts, leave, report);
  const int rounds = separate_parts(state);
  take_best_rounds(state);
  calm_turns(facts.clip, contiguous_runs(state.in_window, facts.loops), facts.height, facts.loops, state.turns);
  state.finder.leave_out({});  // corrections must not add faults of pairs that were harmless
  const std::vector<PosePenetration> after = take_back_turns(state);
  state.finder.leave_out(state.goals.harmless());
  std::vector<MendedEvent> events = mended_events(state);
  Mend out = compared_result(state, after);
  out.events = std::move(events);
  out.rounds = rounds;
  return out;
}

}  // namespace spherechain::baker
