// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace spherechain::baker {

inline constexpr double kConfidence = 0.95;

// The largest share of all poses that something seen in `seen` of `count` independent ones can have, with kConfidence:
// Clopper and Pearson's upper bound, exact for any count. The bound is about 3 / count where `seen` is 0, and 1 where
// there are no poses.
double upper_bound_of_share(int seen, int count);

}  // namespace spherechain::baker
