// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <unordered_map>

#include "baker/import/fbx_file.h"

namespace spherechain::baker {

// Gives models that share a name other names of the same length, in the file's bytes: assimp refers to nodes by their
// names, and fails where two joints have one name. A joint keeps the name where it shares it with a mesh.
// Returns the name of each new name. `file` leads into `bytes`.
std::unordered_map<std::string, std::string> make_names_unique(std::string& bytes, const FbxFile& file);

}  // namespace spherechain::baker
