// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "baker/fix/mend_state.h"

namespace spherechain::baker {

// The result for each event, after look_again. For events that were given up, searches the reason why they stayed about
// as deep; for that, their state becomes open.
std::vector<MendedEvent> mended_events(MendState& state);

}  // namespace spherechain::baker
