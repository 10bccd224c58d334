// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "import/import.h"
#include "roles/roles.h"
#include "segment/segment.h"

namespace spherechain::baker {

// Segments a character by its rig: any number of limbs, any number of pieces, which need not be closed. `roles` are
// those of its rig, which says where forward is. Throws Error(kSegmentation) where the rig moves no limbs with a trunk
// between them, or `facing` says otherwise.
Regions segment_by_rig(const Character& character, const Roles& roles, const std::optional<Vec3>& facing);

}  // namespace spherechain::baker
