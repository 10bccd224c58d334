// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/check/picture.h"
#include "baker/events/find_events.h"
#include "baker/play/play.h"

namespace spherechain::baker {

// Draws a clip's first frame, then the most severe and the deepest event of each two parts and class that is a fault:
// PNGs. A ticket shows the most severe; rules excuse a fault by its parts, its class and its depth, and leave the
// deepest. Sets the eye of each fault, and the number of its picture.
std::vector<std::string> draw_events(const AnimatedAsset& animated, const ClipFrames& clip, ClipEvents& found,
                                     Picture& picture);

}  // namespace spherechain::baker
