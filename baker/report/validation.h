// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "truth/validate.h"

namespace spherechain::baker {

// What `validate` found: as the command line contract has it, and in a screenful.
std::string validation_json(const Validation& validation, const AnimatedAsset& animated,
                            const ValidateSettings& settings);
std::string validation_text(const Validation& validation, const AnimatedAsset& animated,
                            const ValidateSettings& settings);

}  // namespace spherechain::baker
