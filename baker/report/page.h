// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "play/play.h"
#include "spherechain/types.h"

namespace spherechain::baker {

struct PageOptions {
  std::string title, motion;  // what the page calls them
  std::string report;         // of read_bake_report; may be empty
  std::string validation;     // of read_validation; may be empty
  std::string template_file;  // the viewer, as its build made it
  Radius radius = SC_RADIUS_DETECT;
  double fps = 30;
  std::size_t most_bytes = 512'000'000;  // Chromium reads no script of 2^29 letters or more
};

// The page of `spherechain view`: the viewer with all it shows inside (samples/viewer/README.md has the data's shape).
// `progress` is told each frame before it is played. Throws Error(kFile) where the template is not there or no viewer,
// Error(kUsage) where the page has more than `most_bytes`, before many frames are played if their motion alone has.
std::string view_page(const AnimatedAsset& animated, const PageOptions& options,
                      const std::function<void(int)>& progress);

}  // namespace spherechain::baker
