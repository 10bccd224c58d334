// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace spherechain::baker {

// Lower-case hex. The file variant throws Error(kFile) where the file cannot be read.
std::string sha256_of_text(std::string_view text);
std::string sha256_of_file(const std::filesystem::path& path);

}  // namespace spherechain::baker
