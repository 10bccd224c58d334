// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cli/console.h"

#include <algorithm>
#include <cstdint>

#include "baker/mesh/utf8.h"

namespace spherechain::baker {
namespace {

bool is_shown(std::uint32_t code) {
  if (code == '\n' || code == '\t') return true;
  const bool is_control = code < 0x20 || (code >= 0x7F && code < 0xA0);
  const bool is_line_end = code == 0x2028 || code == 0x2029;
  const bool is_direction = code == 0x061C || code == 0x200E || code == 0x200F || (code >= 0x202A && code <= 0x202E) ||
                            (code >= 0x2066 && code <= 0x2069);
  return !is_control && !is_line_end && !is_direction;
}

}  // namespace

std::string for_console(std::string_view text) {
  const std::string whole = as_utf8(text);
  std::string out;
  out.reserve(whole.size());
  for (std::string_view left = whole; !left.empty();) {
    const CodePoint point = *first_code_point(left);
    if (is_shown(point.code)) {
      out += left.substr(0, point.length);
    } else {
      out += fmt::format("\\u{:04x}", point.code);
    }
    left.remove_prefix(point.length);
  }
  return out;
}

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  text.erase(text.find_last_not_of(' ') + 1);
  return for_console(text);
}

void write_console(std::FILE* to, std::string_view text) {
  const std::string shown = for_console(text);
  std::fwrite(shown.data(), 1, shown.size(), to);
}

}  // namespace spherechain::baker
