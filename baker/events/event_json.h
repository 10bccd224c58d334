// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "baker/events/event.h"

namespace spherechain::baker {

// The facts about an event that every JSON file has of it: parts, class, frames, depth, volume, direction, and where a
// camera sees it.
nlohmann::ordered_json event_json(const Event& event);

// All of an event, and back; throws nlohmann::json::exception for other JSON.
nlohmann::ordered_json stored_event(const Event& event);
Event read_stored_event(const nlohmann::ordered_json& json);

}  // namespace spherechain::baker
