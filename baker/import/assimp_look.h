// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "import/assimp_scene.h"
#include "import/look.h"

namespace spherechain::baker {

// Where a picture may be that a material names: where the file says, or beside it, as where its author's disk is not at
// hand.
std::vector<std::filesystem::path> places_of_picture(std::string name, const std::filesystem::path& folder);

// The base colours of a scene that was read from `folder`.
SourceLook read_look(const aiScene& scene, const AssimpScene& flat, const std::filesystem::path& folder);

}  // namespace spherechain::baker
