// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "baker/play/play.h"
#include "baker/play/responder.h"
#include "baker/volumes/colliders.h"
#include "spherechain/types.h"

namespace spherechain::baker {

struct PageOptions {
  std::string title;
  std::string motion;                                   // name of a motion that is not a clip
  std::string report;                                   // of read_bake_report; may be empty
  std::string validation;                               // of read_validation; may be empty
  std::string template_file;                            // the page without data, as its build made it
  std::vector<char> asset;                              // its bytes, for a page that finds contacts itself
  std::array<std::string, 2> names{"first", "second"};  // of two characters
  // Else they are one character, before and after a change: what touches between the two is not shown, the page can lay
  // them over each other, and it opens where the deepest fault was.
  bool they_meet = true;
  std::string events;  // of such a change: JSON, as fix.json has a clip's
  Radius radius = SC_RADIUS_DETECT;
  const Colliders* colliders = nullptr;  // to show; null: none
  Responder* responder = nullptr;        // corrects the poses; null: they stay as animated
  double fps = 30;
  std::size_t max_bytes = 512'000'000;  // Chromium reads no script of 2^29 letters or more
};

// Above this many bytes a page takes browsers seconds to open.
inline constexpr std::size_t kLargePageBytes = 50'000'000;

// The page of `spherechain view`: the template with its data inside (baker/page/README.md describes them). `progress`
// gets each frame before it is played. Throws Error(kFile) where the template is missing or no page, or where the
// asset cannot tell contacts; Error(kUsage) where the page has more than `max_bytes`, before many frames are played if
// their motion alone has.
std::string view_page(const AnimatedAsset& animated, const PageOptions& options,
                      const std::function<void(int)>& progress);

// Data that the pages of a character's clips share, as JSON: the keys that do not depend on a motion, without chains.
std::string character_page(const AnimatedAsset& animated);

}  // namespace spherechain::baker
