// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "baker/play/play.h"

namespace spherechain::baker {

// --continuous: look_between_frames(), with progress.
void look_between(AnimatedAsset& animated, const std::string& asset);

}  // namespace spherechain::baker
