// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "bind/bind.h"
#include "import/import.h"
#include "rig/rig.h"
#include "segment/segment.h"

namespace spherechain::baker {

// Random poses that a calibration takes. A mesh of more than 50,000 triangles takes fewer.
inline constexpr int kCalibrationPoses = 600;

// Fits the detect radii and the rest pairs of `binding` to what truly touches in random poses:
// 1. The detect radius of a sphere that follows the bones grows where it misses contacts. Spheres of limbs and torso
//    miss next to none.
// 2. Two spheres that touch at rest, or nearly, are a rest pair. It is reported below the larger of two distances:
//    that at rest less 0.6 of the gap between the skins, and the greatest at which a report is worth its false alarms.
//    Where the skins are within 0.3 % of the height at rest, the pair is tested like any other.
// A character that has neither bones nor joints takes no poses: its radii stay, and the first distance alone counts.
// `asset` is one of this binding, whatever its rest pairs. The same input gives the same result.
void calibrate(const Character& character, const Regions& regions, const std::vector<Joint>& joints,
               const std::vector<std::uint8_t>& asset, Binding& binding);

}  // namespace spherechain::baker
