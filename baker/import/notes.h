// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

namespace spherechain::baker {

// What imports tell the user beside their result, such as files that are named and not read: a line each, which begins
// with the file's name. They wait in this process until a command shows them. Not for several threads.
void add_note(const std::string& note);  // once, however often it comes
std::vector<std::string> take_notes();

}  // namespace spherechain::baker
