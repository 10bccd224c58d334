// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "baker/import/assimp_scene.h"
#include "baker/import/import.h"

namespace spherechain::baker {

// A scene as a binary glTF: all of `source`, which was read from it with its look, in metres with Y up. Nodes and clips
// have the numbers that they have in `source` (in_file), and vertices their order. A node on top turns and scales where
// the file has another unit or axis.
std::string glb_of(const aiScene& scene, const AssimpScene& flat, const SourceMesh& source);
// The same of one mesh with bones that no scene was read for.
std::string glb_of(const SourceMesh& source);

}  // namespace spherechain::baker
