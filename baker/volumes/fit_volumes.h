// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "baker/play/asset_file.h"
#include "baker/volumes/colliders.h"
#include "baker/volumes/fit_one.h"

namespace spherechain::baker {

inline constexpr const char* kVolumeShapes[] = {"spheres", "cones", "capsules", "ellipsoids", "boxes"};
VolumeShape volume_shape(const std::string& name);  // one of those

// The asset's body parts with volumes of one shape, `at_most` of them in all; 0: as many as pay. They go where they
// bring the skin and the volumes' surface nearest to each other. Where there are more parts than volumes, and of small
// parts, the volumes of the part that one hangs on stand for it, too: those first that leave them least when their
// joint bends. Spheres without a limit are as many as the asset's own. A pair of bodies need not be tested, and is
// ignored, where one hangs on the other or where their volumes overlap at rest.
Colliders fit_volumes(const OpenAsset& asset, VolumeShape shape, int at_most);

}  // namespace spherechain::baker
