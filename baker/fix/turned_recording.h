// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/motion/carried_motion.h"

namespace spherechain::baker {

// Turns the joints of a BVH recording so that retargeting it again gives the clip `after` instead of `before`, which is
// carried.clip(). Returns the recording's text. Frames outside of `in_window` (frames at `fps`) do not change. Throws
// Error(kFile) if a joint that must turn has no rotations about three axes.
std::string turned_recording(const CarriedMotion& carried, const SourceRig& rig, const Clip& before, const Clip& after,
                             const std::vector<char>& in_window, double fps);

}  // namespace spherechain::baker
