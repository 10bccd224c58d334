// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "truth/validate.h"

namespace spherechain::baker {

// Results of `validate`: as JSON (docs/json.md), and as a screenful of text.
std::string validation_json(const Validation& validation, const AnimatedAsset& animated,
                            const ValidateSettings& settings);
std::string validation_text(const Validation& validation, const AnimatedAsset& animated,
                            const ValidateSettings& settings);

}  // namespace spherechain::baker
