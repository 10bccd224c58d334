// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace spherechain::baker {

struct CodePoint {
  std::uint32_t code;
  std::size_t length;  // bytes
};

// The code point at the start of a text that is not empty; none where its first bytes are not UTF-8.
std::optional<CodePoint> first_code_point(std::string_view text);

// The text with each byte that is not UTF-8 as "\xff". Names of files and clips may hold any bytes; names that are
// written to JSON and compared with what is read from it must be text.
std::string as_utf8(std::string_view text);

}  // namespace spherechain::baker
