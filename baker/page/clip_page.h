// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "baker/events/find_events.h"
#include "baker/page/page_motion.h"
#include "baker/play/play.h"

namespace spherechain::baker {

// Data of a clip's page: its frames with their contacts, and its motion. JSON with the keys of baker/page/README.md.
std::string clip_page(const AnimatedAsset& animated, const ClipFrames& clip, const ClipEvents& found,
                      const PageMotion& motion);

}  // namespace spherechain::baker
