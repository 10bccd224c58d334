// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/fix/look.h"

namespace spherechain::baker {

// Compares a round with the rounds before. Searches a way out for events without progress, once each. Gives up events
// that never improved. Returns false if the whole clip makes no progress any more.
bool makes_progress(MendState& state, const Look& look, int round);

// Opens the events again that were given up, for another budget. Returns false if there were none.
bool reopen_events(MendState& state);

}  // namespace spherechain::baker
