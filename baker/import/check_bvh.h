// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace spherechain::baker {

// Throws Error(kFile) for a BVH file (its first word is HIERARCHY) that would crash assimp or use up the memory: assimp
// reads nested joints on the stack, and allocates as many frames as the file claims. Also for one whose frame time is
// not positive, which assimp accepts.
void check_bvh(const std::filesystem::path& path);

}  // namespace spherechain::baker
