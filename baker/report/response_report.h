// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "baker/play/responder.h"

namespace spherechain::baker {

// How a motion changes by the response: `response` of `play --json`, and a line for people.
nlohmann::ordered_json response_json(const ResponseMeasures& of);
std::string response_text(const ResponseMeasures& of, const AnimatedAsset& animated);

}  // namespace spherechain::baker
