// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

inline nlohmann::ordered_json to_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace spherechain::baker
