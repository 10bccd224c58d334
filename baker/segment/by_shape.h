// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/mesh/attempt.h"
#include "baker/segment/segment.h"

namespace spherechain::baker {

// Segments a character by the shape of its body alone. There is no result where the body is not one closed surface or
// lacks a limb.
Attempt<Regions> segment_by_shape(const Character& character, const SegmentSettings& settings);

}  // namespace spherechain::baker
