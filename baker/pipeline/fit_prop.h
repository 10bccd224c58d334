// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "baker/pipeline/pipeline.h"

namespace spherechain::baker {

// Spheres for a rigid thing, which hold all of it at their detect radii: pieces by the fit by halves, each in the
// smallest sphere around it. There are none where a sphere finds no pivots.
Attempt<FittedCharacter> fit_prop(const Character& prop, const BakeSettings& settings);

}  // namespace spherechain::baker
