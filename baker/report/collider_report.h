// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "baker/play/play.h"
#include "baker/truth/collider_alarms.h"

namespace spherechain::baker {

// The alarms of a robot's own colliders over all frames that `animated` plays; no poses for a character without.
ColliderAlarms collider_alarms_of(const AnimatedAsset& animated);

// Lines for people, and docs/json.md.
std::string collider_text(const ColliderAlarms& alarms, const AnimatedAsset& animated);
nlohmann::ordered_json collider_json(const ColliderAlarms& alarms, const AnimatedAsset& animated);

}  // namespace spherechain::baker
