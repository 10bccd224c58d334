// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cli/between.h"

#include <fmt/format.h>

#include "baker/cli/progress.h"
#include "baker/play/steps.h"
#include "baker/play/target.h"

namespace spherechain::baker {

void look_between(AnimatedAsset& animated, const std::string& asset) {
  Progress progress(asset + ": between frames:");
  const int count = animated.frame_count();
  look_between_frames(animated, choose_target("auto"),
                      [&](int i) { progress.show(fmt::format("frame {} of {}", i + 1, count)); });
}

}  // namespace spherechain::baker
