// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "motion/carried_motion.h"

namespace spherechain::baker {

// The text of a BVH recording, its joints turned so that, carried over again, the character does what `after` says in
// place of `before`, which is carried.clip(). Frames outside of the windows stay as they are; windows are of frames at
// `fps`. Throws Error(kFile) where a joint that is to turn has no rotations about three axes.
std::string turned_recording(const CarriedMotion& carried, const SourceRig& rig, const Clip& before, const Clip& after,
                             const std::vector<char>& in_window, double fps);

}  // namespace spherechain::baker
