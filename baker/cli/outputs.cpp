// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/outputs.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "mesh/error.h"
#include "play/asset_file.h"

namespace spherechain::baker {

namespace fs = std::filesystem;

void check_folder(const std::string& file) {
  const fs::path folder = fs::absolute(file).parent_path();
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) {
    throw Error(ExitCode::kFile, file + ": cannot be created (there is no folder " + folder.string() + ")");
  }
  if (::access(folder.c_str(), W_OK) != 0) {
    throw Error(ExitCode::kFile, file + ": cannot be created (the folder " + folder.string() + " is not writable)");
  }
}

void check_replaceable(const std::string& file, std::string_view magic, const std::string& kind, bool force,
                       std::size_t offset) {
  std::error_code ignored;
  if (force || !fs::is_regular_file(file, ignored) || fs::file_size(file, ignored) == 0) return;
  const std::string there = read_file(file);
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  if (there.size() < offset + magic.size() ||
      !std::equal(magic.begin(), magic.end(), there.begin() + static_cast<std::ptrdiff_t>(offset), same)) {
    throw Error(ExitCode::kFile, file + ": exists and is not " + kind + " (--force replaces it)");
  }
}

}  // namespace spherechain::baker
