// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "baker/write/own_file.h"
#include "baker/write/version.h"

namespace spherechain::baker {

// Marks a glTF that this tool changed as its own.
inline void mark_as_own(nlohmann::ordered_json& gltf) {
  nlohmann::ordered_json& extras = gltf["asset"]["extras"];
  if (extras.is_null() || extras.is_object()) extras[kGltfMark] = kVersion;
}

}  // namespace spherechain::baker
