// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/store.h"

#include <fstream>
#include <sstream>

#include "baker/mesh/error.h"
#include "baker/os/sha256.h"
#include "baker/os/written_file.h"
#include "baker/write/version.h"

namespace spherechain::baker {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kSealSize = 65;  // SHA-256 in hex, and the end of a line

std::string seal(const std::string& key, const std::string& kind, std::string_view bytes) {
  return sha256_of_text((key + kind + "\n").append(bytes)) + "\n";
}

}  // namespace

Store::Store(fs::path folder) : folder_(std::move(folder)) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw Error(ExitCode::kFile, folder_.string() + ": cannot be created (" + error.message() + ")");
}

std::optional<std::string> Store::read(const std::string& key, const std::string& kind) const {
  const fs::path file = path(key, kind);
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return {};
  std::ifstream in(file, std::ios::binary);
  std::string own_seal(kSealSize, '\0');
  std::ostringstream bytes;
  if (!in.read(own_seal.data(), static_cast<std::streamsize>(kSealSize))) return {};
  if (in.peek() != std::ifstream::traits_type::eof()) bytes << in.rdbuf();
  if (in.bad() || seal(key, kind, bytes.view()) != own_seal) return {};
  return std::move(bytes).str();
}

std::string Store::take(const std::string& key, const std::string& kind) const {
  std::optional<std::string> bytes = read(key, kind);
  if (!bytes) fail_lost();
  return *std::move(bytes);
}

void Store::fail_lost() const {
  throw Error(ExitCode::kFile, folder_.string() + ": results are lost (run the check again)");
}

void Store::write(const std::string& key, const std::string& kind, std::string_view bytes) const {
  const fs::path file = path(key, kind);
  std::error_code error;
  if (fs::create_directories(file.parent_path(), error); error) {
    throw Error(ExitCode::kFile, file.parent_path().string() + ": cannot be created (" + error.message() + ")");
  }
  if (fs::is_directory(file, error)) fs::remove(file, error);  // an empty one; others are somebody's
  write_atomically(file, seal(key, kind, bytes).append(bytes));
}

// Folders of some hundreds of files each are quick to list.
fs::path Store::path(const std::string& key, const std::string& kind) const {
  return folder_ / key.substr(0, 2) / (key.substr(2, 30) + kind);
}

const std::string& tool_identity() {
  static const std::string identity = std::string(kVersion) + "-" + sha256_of_file("/proc/self/exe").substr(0, 16);
  return identity;
}

}  // namespace spherechain::baker
