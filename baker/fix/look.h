// SPDX-License-Identifier: GPL-3.0-or-later
// Measures the penetrations of the turned clip at each stage of a fix.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "baker/fix/mend_state.h"
#include "baker/fix/ways_out.h"

namespace spherechain::baker {

// Measures the source clip, and collects its events. `leave` and `report`: see mend_clip.
MendState first_look(const ClipFacts& facts, const std::function<bool(const Event&)>& leave,
                     const std::function<void(const std::string&)>& report);

// Penetrations of a round, and the sum of their residuals in the source's units.
struct Look {
  std::vector<PosePenetration> found;
  double residual;
};
// Measures the frames that may have changed, in the first round of a budget all, and adds a separation for each
// penetration that is too deep. Once no frame has a fault, and in every few rounds, also measures between frames, and
// keeps the round in `state.rounds`.
Look look_in_round(MendState& state, int round, bool is_first);

// Measures all frames, and between frames that may have changed, and adds separations likewise. Returns the sum of the
// residuals.
double separate_everywhere(MendState& state);

// True if parts intersect by more than the margin, although they must be apart.
bool has_deep_contacts(const MendState& state, const std::vector<PosePenetration>& found);

// Measures all frames, and between frames that may have changed. Updates the state, the depth and the turn of each
// event: freed, open if it became shallower, or else given up.
std::vector<PosePenetration> look_again(MendState& state);

// The same as `check` will find it, frame by frame.
std::vector<PosePenetration> look_as_check(MendState& state);

// Returns a function that measures candidate poses of a limb. `state` and `limb` must outlive it.
EvaluatePoses residuals_of(MendState& state, const LimbInTrouble& limb);

}  // namespace spherechain::baker
