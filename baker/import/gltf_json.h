// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace spherechain::baker {

// Returns the parts of a glTF's JSON that a character is made of: no images, materials or cameras; of `extras` the
// names of morph targets; of extensions their names. The name that a VRM avatar gives a node as a bone of its humanoid
// is the node's `extras.humanoid`. Every member has its type and every index refers to something, so that later readers
// need not check. The contents of buffers are not checked. Throws Error(kFile) that names `file` and the place in it,
// also for a required extension that is unknown.
nlohmann::json check_gltf_json(std::string_view text, const std::string& file);

}  // namespace spherechain::baker
