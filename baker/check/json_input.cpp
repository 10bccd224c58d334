// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/json_input.h"

#include <fmt/format.h>

#include <algorithm>

#include "baker/import/json_depth.h"
#include "baker/mesh/error.h"

namespace spherechain::baker {

nlohmann::ordered_json parse_input(const std::string& text, const std::string& file, const std::string& refusal) {
  constexpr int kNestedMax = 100;
  const std::string start = file + ": " + refusal + ": ";
  const std::size_t first = text.find_first_not_of(" \t\r\n\xEF\xBB\xBF");
  const bool may_be_json = first != std::string::npos && (text[first] == '{' || text[first] == '[');
  if (may_be_json && json_depth(text) > kNestedMax) throw Error(ExitCode::kFile, start + "it is nested too deeply");
  try {
    return nlohmann::ordered_json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    const auto line = 1 + std::count(text.begin(), end, '\n') - (end != text.begin() && end[-1] == '\n' ? 1 : 0);
    throw Error(ExitCode::kFile, fmt::format("{}line {} is not JSON", start, line));
  }
}

}  // namespace spherechain::baker
