// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "baker/pipeline/pipeline.h"

namespace spherechain::baker {

// A bake for other tools, as the bytes of a GLB file: the skin coloured by region and skinned to the joints, and every
// sphere at its radius at rest as a node below the joint that carries it, named left_arm_03 (from shoulder or hip
// outwards) or torso_level_2_left (from the bottom).
//
// The root node's transform gives metres, y up, facing z as glTF wants it, from the character's own axes: they are sure
// where a file's up axis is a guess. Everything below it keeps the file's coordinates.
std::string preview_glb(const Bake& bake);

}  // namespace spherechain::baker
