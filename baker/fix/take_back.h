// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/fix/mend_state.h"

namespace spherechain::baker {

// Takes back turns that do harm or nothing: fades them out around frames that got worse than before, then removes them
// from whole runs of frames that still got worse or in which no event improved. Returns the penetrations that are left.
std::vector<PosePenetration> take_back_turns(MendState& state);

}  // namespace spherechain::baker
