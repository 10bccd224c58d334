// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace spherechain::baker {

// A glTF's JSON with only what a character is made of: no images, materials or cameras, of `extras` only the names of
// morph targets, of extensions only their names. Every member has its type and every index leads to something, so that
// what reads it next need not ask; what buffers hold is another matter. Throws Error(kFile) that names `file` and the
// place in it, also for an extension that is required and not known.
nlohmann::json check_gltf_json(std::string_view text, const std::string& file);

}  // namespace spherechain::baker
