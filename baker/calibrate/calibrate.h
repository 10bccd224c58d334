// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/bind/bind.h"
#include "baker/import/import.h"
#include "baker/rig/rig.h"
#include "baker/segment/segment.h"

namespace spherechain::baker {

// Random poses that a calibration takes. A mesh of more than 17,000 triangles takes fewer.
inline constexpr int kCalibrationPoses = 1800;

// Fits the detect radii and the rest pairs of `binding` to what truly touches in random poses:
// 1. Each pair gets a distance below which it is reported: where the contacts that it finds are worth their false
//    alarms (reach.h). Spheres that nearly touch at rest should reach as far as their distance there less 0.6 of the
//    gap between the skins, or 1.03 of that distance where the gap is below 0.3 % of the height.
// 2. Detect radii of spheres that follow the bones become what these distances need. The radii of a body of limbs and
//    torso alone stay: they miss next to nothing. Radii that a person chose stay, too.
// 3. A pair becomes a rest pair where its own distance is below the sum of the radii, and saves false alarms in more
//    than 1 % of the poses, or at rest.
// A character that has neither bones nor joints takes no poses: its radii stay, and the distance at rest alone counts.
// `draft` is an asset with this binding and any rest pairs. The same input gives the same result.
void calibrate(const Character& character, const Regions& regions, const std::vector<Joint>& joints,
               const std::vector<std::uint8_t>& draft, Binding& binding);

}  // namespace spherechain::baker
