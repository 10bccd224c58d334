// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <assimp/scene.h>

#include "baker/import/fbx_file.h"

namespace spherechain::baker {

// Puts an FBX scene into the file's own axes and unit, and its bones where the file says that the skin was bound.
// Assimp 5.2 does so; from 5.4 on it turns and scales the scene's root, and binds the skin where its node lies at rest.
void keep_space_and_binds(aiScene& scene, const FbxFile& file);

}  // namespace spherechain::baker
