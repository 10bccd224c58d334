// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string_view>

namespace spherechain::baker {

// True if bytes go straight to what `path` names: a pipe, a device, or what the program was started with under the name
// of a descriptor (/dev/stdout), which a rename would take away from everybody.
bool is_written_directly(const std::filesystem::path& path);

// The file that writing to `path` makes or replaces: where links lead, there or not; what is written directly is
// itself. Throws Error(kFile) for links that the system does not follow.
std::filesystem::path written_file(const std::filesystem::path& path);

// Writes a file that is either whole or untouched: next to it, then by a rename. Links to it stay. A file that is
// written directly gets the bytes at once. Throws Error(kFile).
void write_atomically(const std::filesystem::path& path, std::string_view bytes);

}  // namespace spherechain::baker
