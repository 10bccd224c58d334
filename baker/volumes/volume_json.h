// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>

#include "baker/volumes/colliders.h"

namespace spherechain::baker {

nlohmann::ordered_json json_of(const Vec3& v);
nlohmann::ordered_json json_of(const Eigen::Quaterniond& q);  // x y z w
nlohmann::ordered_json json_of(const Volume& volume);
const char* reason_name(IgnoredReason reason);

}  // namespace spherechain::baker
