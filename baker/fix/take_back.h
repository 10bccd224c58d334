// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/fix/mend_state.h"

namespace spherechain::baker {

// Takes back turns that do harm or nothing, around the frames in which they do: they made something worse, moved a
// foot, or made their limb's faults hardly better. Where no smaller turn helps, all of it is removed from its whole run
// of frames, as are turns of runs in which no event improved.
void take_back_turns(MendState& state);

}  // namespace spherechain::baker
