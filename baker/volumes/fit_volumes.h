// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "play/asset_file.h"
#include "volumes/colliders.h"

namespace spherechain::baker {

enum class VolumeShape : std::uint8_t { kSpheres, kCones, kCapsules, kEllipsoids, kBoxes };

// The asset's body parts with volumes of one shape, `at_most` of them in all; 0: as many as pay. Spheres without a
// limit are the asset's own. What need not be tested at rest is ignored.
Colliders fit_volumes(const OpenAsset& asset, VolumeShape shape, int at_most);

}  // namespace spherechain::baker
