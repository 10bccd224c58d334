// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace spherechain::baker {

// Parses the text of `file`, which a person may have written. Throws Error(kFile): "FILE: <refusal>: line 3 is not
// JSON". So it does for a text that is nested more deeply than any file that people write.
nlohmann::ordered_json parse_input(const std::string& text, const std::string& file, const std::string& refusal);

}  // namespace spherechain::baker
