// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/os/access.h"

#include <unistd.h>

#include <cerrno>

namespace spherechain::baker {
namespace {

std::error_code check(const std::filesystem::path& path, int mode) {
  return ::access(path.c_str(), mode) == 0 ? std::error_code() : std::error_code(errno, std::generic_category());
}

}  // namespace

std::error_code check_readable(const std::filesystem::path& path) { return check(path, R_OK); }
std::error_code check_writable(const std::filesystem::path& path) { return check(path, W_OK); }
std::error_code check_takes_files(const std::filesystem::path& folder) { return check(folder, W_OK | X_OK); }

}  // namespace spherechain::baker
