// SPDX-License-Identifier: GPL-3.0-or-later
#include "play/asset_file.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "import/import.h"
#include "mesh/error.h"

namespace spherechain::baker {

std::string read_file(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_fifo(path, ignored)) check_regular_file(path);
  std::ifstream in(path, std::ios::binary);
  std::ostringstream bytes;
  if (in.peek() != std::ifstream::traits_type::eof()) bytes << in.rdbuf();
  if (!in.is_open() || in.bad()) throw Error(ExitCode::kFile, path + ": cannot be read");
  return std::move(bytes).str();
}

AssetFile open_asset(const std::string& path) {
  const std::string bytes = read_file(path);
  AssetFile file;
  file.bytes = std::make_unique<std::uint64_t[]>(bytes.size() / sizeof(std::uint64_t) + 1);
  std::memcpy(file.bytes.get(), bytes.data(), bytes.size());
  char message[256] = "";
  const Status status = file.asset.open(file.bytes.get(), bytes.size(), message, sizeof(message));
  if (status != Status::kOk) {
    throw Error(ExitCode::kFile,
                path + ": " + to_string(status) + (message[0] ? std::string(": ") + message : "") + " (bake it again)");
  }
  return file;
}

}  // namespace spherechain::baker
