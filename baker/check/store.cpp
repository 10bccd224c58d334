// SPDX-License-Identifier: GPL-3.0-or-later
#include "check/store.h"

#include <fstream>
#include <sstream>

#include "import/sha256.h"
#include "mesh/error.h"
#include "write/version.h"
#include "write/write.h"

namespace spherechain::baker {

namespace fs = std::filesystem;

Store::Store(fs::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw Error(ExitCode::kFile, folder_.string() + ": cannot be created (" + error.message() + ")");
}

// Folders of some hundreds of files each are quick to list.
fs::path Store::path(const std::string& key, const char* kind) const {
  return folder_ / key.substr(0, 2) / (key.substr(2, 30) + kind);
}

bool Store::has(const std::string& key, const char* kind) const {
  std::error_code ignored;
  return fs::is_regular_file(path(key, kind), ignored);
}

std::optional<std::string> Store::read(const std::string& key, const char* kind) const {
  std::ifstream in(path(key, kind), std::ios::binary);
  if (!in.is_open()) return {};
  std::ostringstream bytes;
  bytes << in.rdbuf();
  return std::move(bytes).str();
}

void Store::write(const std::string& key, const char* kind, std::string_view bytes) const {
  const fs::path file = path(key, kind);
  std::error_code error;
  if (fs::create_directories(file.parent_path(), error); error) {
    throw Error(ExitCode::kFile, file.parent_path().string() + ": cannot be created (" + error.message() + ")");
  }
  write_atomically(file, bytes);
}

const std::string& tool_identity() {
  static const std::string identity = std::string(kVersion) + "-" + sha256_of_file("/proc/self/exe").substr(0, 16);
  return identity;
}

}  // namespace spherechain::baker
