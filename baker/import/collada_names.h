// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <assimp/scene.h>

#include <string>
#include <unordered_map>

namespace spherechain::baker {

// True if assimp read a Collada file. Its nodes have an id, which is unique, and a name, which people see; either may
// be missing.
bool is_collada(const aiScene& scene);

// True if each node has a name of its own. `scene` was read by names.
bool names_are_unique(const aiScene& scene);

// The names of nodes by their ids. `by_id` and `by_name` are one file, read in both ways.
std::unordered_map<std::string, std::string> names_of_ids(const aiScene& by_id, const aiScene& by_name);

}  // namespace spherechain::baker
