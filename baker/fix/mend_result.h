// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/fix/mend_state.h"

namespace spherechain::baker {

// Compares the fixed clip with the source clip. `after`: the penetrations that are left. The result lacks its events
// and its number of rounds.
Mend compared_result(MendState& state, const std::vector<PosePenetration>& after);

}  // namespace spherechain::baker
