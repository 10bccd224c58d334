// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "baker/mesh/mesh.h"

namespace spherechain::baker {

inline nlohmann::ordered_json to_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline Vec3 read_vec3(const nlohmann::ordered_json& v) {
  return {v.at(0).get<double>(), v.at(1).get<double>(), v.at(2).get<double>()};
}

}  // namespace spherechain::baker
