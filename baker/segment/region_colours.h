// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "baker/segment/segment.h"

namespace spherechain::baker {

using Colour = std::array<float, 3>;  // red, green, blue from 0 to 1, sRGB

// Okabe and Ito's palette, which colour-blind readers can tell apart, in the order of a biped's regions. Further
// regions start again with the first colour.
inline constexpr std::array<Colour, 5> kRegionColours{{
    {0.000f, 0.447f, 0.698f},  // blue: left arm
    {0.902f, 0.624f, 0.000f},  // orange: right arm
    {0.337f, 0.706f, 0.914f},  // sky blue: left leg
    {0.800f, 0.475f, 0.655f},  // reddish purple: right leg
    {0.000f, 0.620f, 0.451f},  // bluish green: torso
}};

}  // namespace spherechain::baker
