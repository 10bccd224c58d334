// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace spherechain::baker {

inline constexpr double kConfidence = 0.95;

// The largest share of all poses that something seen in `seen` of `count` independent ones can have, with kConfidence:
// Clopper and Pearson's upper bound, exact for any count. Seen in none: about 3 / count. Of no poses: 1.
double upper_bound_of_share(int seen, int count);

}  // namespace spherechain::baker
