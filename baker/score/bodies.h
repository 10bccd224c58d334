// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace spherechain::baker {

// True if a folder is MakeHuman's folder of data: it has the base mesh.
bool is_makehuman(const std::filesystem::path& folder);

// Makes people from baby to old and from thin to heavy of such a folder, and writes each as a GLB. Returns the files.
// Throws Error(kFile) as make_body() does.
std::vector<std::string> write_bodies(const std::filesystem::path& makehuman, const std::filesystem::path& to);

}  // namespace spherechain::baker
