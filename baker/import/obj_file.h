// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

namespace spherechain::baker {

// The material libraries (.mtl) that an OBJ file names, whether they exist or not, and the one with the OBJ's own name,
// which assimp reads where the others are missing.
std::vector<std::filesystem::path> files_of_obj(const std::filesystem::path& path);

}  // namespace spherechain::baker
