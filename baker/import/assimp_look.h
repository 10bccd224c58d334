// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "baker/import/assimp_scene.h"
#include "baker/import/look.h"

namespace spherechain::baker {

// The base colours of a scene that was read from `folder`.
SourceLook read_look(const aiScene& scene, const AssimpScene& flat, const std::filesystem::path& folder);

}  // namespace spherechain::baker
