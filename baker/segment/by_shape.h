// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/mesh/attempt.h"
#include "baker/segment/segment.h"

namespace spherechain::baker {

// Segments a character by the shape of `body` alone, its largest piece or another surface made of its skin. There is no
// result where the body is not one closed surface or lacks a limb.
Attempt<Regions> segment_by_shape(const Character& character, const BodyMesh& body, const SegmentSettings& settings);

}  // namespace spherechain::baker
