// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <string_view>

namespace spherechain::baker {

// The text without what changes a console or the order of its letters: names come from strangers' files. Control
// characters but line ends and tabs, marks of writing direction, and other line ends are shown as "\u001b", which is
// their name in JSON, too; a byte that is no UTF-8 as "\xff".
std::string for_console(std::string_view text);

// The same in one line, without blanks at its end: line ends in a file's name or an importer's words are blanks.
std::string one_line(std::string text);

// All that commands print goes through here.
void write_console(std::FILE* to, std::string_view text);

template <typename... Args>
void say(std::FILE* to, fmt::format_string<Args...> format, Args&&... args) {
  write_console(to, fmt::format(format, std::forward<Args>(args)...));
}
template <typename... Args>
void say(fmt::format_string<Args...> format, Args&&... args) {
  write_console(stdout, fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace spherechain::baker
