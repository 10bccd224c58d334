// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

namespace spherechain::baker {

// assimp reads joints within joints on the stack, keeps a joint at hand while its children move it, and makes room for
// as many frames as the file promises: a BVH file (HIERARCHY is its first word) that would bring it down is refused.
// So is one whose frames take no time, or less, which it reads as it stands.
// Throws Error(kFile).
void check_bvh(const std::filesystem::path& path);

}  // namespace spherechain::baker
