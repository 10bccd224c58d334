// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace spherechain::baker {

// Files round times, and importers do, to milliseconds: what is this near to a frame lies on it.
inline constexpr double kFrameRounding = 0.05;  // of a frame
inline constexpr double kFramesMax = 1e6;       // of all clips together

// Frames that a motion of so many seconds has, one every 1 / fps seconds from 0 on: the last where the motion ends, or
// less than a frame before. A motion without a length has one.
int frames_in(double seconds, double fps);

// The rate to look at a motion with when `fps` is asked for: that which goes evenly with the motion's own where the two
// hardly differ (29.97 for 30, and 59.94 / 2), so that frames stay on its keys to the end. 0 asks for its own.
double even_rate(double fps, double own);

}  // namespace spherechain::baker
