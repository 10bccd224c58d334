// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <assimp/scene.h>

#include "baker/import/fbx_file.h"

namespace spherechain::baker {

// Where a node has pivots, and its translation, rotation or scale has curves for some axes alone, assimp takes the
// others for 0 (scale: 1). This puts the values into the keys that the file has for them.
void complete_curves(aiScene& scene, const FbxFile& file);

}  // namespace spherechain::baker
