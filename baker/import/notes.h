// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace spherechain::baker {

// Notes to the user, such as missing files: one line each, which begins with the file's name. They wait in this process
// until a command prints them. Not thread-safe.
void add_note(const std::string& note);  // once, however often it comes
std::vector<std::string> take_notes();

}  // namespace spherechain::baker
