// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <vector>

namespace spherechain::baker {

// The material libraries (.mtl) that an OBJ file names, there or not, and the one of its own name, which assimp reads
// where those are not there.
std::vector<std::filesystem::path> files_of_obj(const std::filesystem::path& path);

}  // namespace spherechain::baker
