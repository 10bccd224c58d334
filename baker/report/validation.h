// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "baker/truth/validate.h"

namespace spherechain::baker {

nlohmann::ordered_json score_json(const Score& score);
// The result of `validate` as JSON (docs/json.md) and as text for a console.
std::string validation_json(const Validation& validation, const AnimatedAsset& animated,
                            const ValidateSettings& settings);
std::string validation_text(const Validation& validation, const AnimatedAsset& animated,
                            const ValidateSettings& settings);

}  // namespace spherechain::baker
