// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/fix/mend_state.h"

namespace spherechain::baker {

// Takes the turns of the round with the least penetration, for each run of frames; among equal rounds the last one.
// Events that were given up are opened again, so that their penetration counts.
void take_best_rounds(MendState& state);

}  // namespace spherechain::baker
