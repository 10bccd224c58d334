// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/mesh/attempt.h"
#include "baker/roles/roles.h"
#include "baker/segment/segment.h"

namespace spherechain::baker {

// Segments a body that is part of the skin by the rig: any number of limbs, any number of pieces, which need not be
// closed. `roles` are those of its rig; the rig's left and right say where forward is. There is no result where the rig
// moves no limbs with a trunk between them, or where the settings ask for another body or facing.
Attempt<Regions> segment_by_rig(const Character& character, BodyMesh body, const Roles& roles,
                                const SegmentSettings& settings);

// True if less than half of the limbs' skin is of its limb's largest piece: rings around such limbs have gaps anywhere.
bool limbs_are_in_shards(const Mesh& skin, const Regions& regions);

}  // namespace spherechain::baker
