// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/fix/mend_state.h"

namespace spherechain::baker {

// One Gauss-Newton step over the whole clip: opens windows around all separations and target turns, solves for the
// turns, and moves towards them within the step limit, the budget and the hinges. While faults are left (`is_free` is
// false), turns are also kept near those at the start of the step. Returns the largest step of a joint in radians.
double gauss_newton_step(MendState& state, int round, bool is_free);

}  // namespace spherechain::baker
