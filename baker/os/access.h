// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <system_error>

namespace spherechain::baker {

// No error where this user may read a file, write to it, or put files into a folder.
std::error_code check_readable(const std::filesystem::path& path);
std::error_code check_writable(const std::filesystem::path& path);
std::error_code check_takes_files(const std::filesystem::path& folder);

}  // namespace spherechain::baker
