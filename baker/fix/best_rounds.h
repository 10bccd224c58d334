// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/fix/mend_state.h"

namespace spherechain::baker {

// Composes the turns of a clip: each frame takes those of one round, or none, so that little of its faults is left and
// the joints turn little and smoothly.
void take_best_rounds(MendState& state);

}  // namespace spherechain::baker
