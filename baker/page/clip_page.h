// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <vector>

#include "baker/events/find_events.h"
#include "baker/page/page_motion.h"
#include "baker/play/play.h"

namespace spherechain::baker {

// Skin that shows through clothes, as the page colours it.
struct PagePoke {
  std::array<std::array<Index, 2>, 2> pieces;  // first triangle and count: of the skin, and of what it shows through
  std::vector<Index> triangles;                // that show
};

// Data of a clip's page: its frames with their contacts, and its motion. JSON with the keys of baker/page/README.md.
std::string clip_page(const AnimatedAsset& animated, const ClipFrames& clip, const ClipEvents& found,
                      const std::vector<PagePoke>& pokes, const PageMotion& motion);

}  // namespace spherechain::baker
