// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/file_hash.h"

#include <cstdint>

#include "baker/import/import.h"
#include "baker/os/child_process.h"
#include "baker/os/sha256.h"

namespace spherechain::baker {

namespace fs = std::filesystem;

// For a file that is too large for any importer, its size stands: a sparse file of terabytes costs nothing to send.
std::string hash_of_input(const fs::path& file) {
  constexpr std::uintmax_t kReadMax = std::uintmax_t{1} << 32;
  check_regular_file(file);
  const auto of_one = [](const fs::path& one) {
    std::error_code ignored;
    if (!fs::is_regular_file(one, ignored)) return std::string("-");
    const std::uintmax_t size = fs::file_size(one, ignored);
    return size > kReadMax ? std::to_string(size) : sha256_of_file(one);
  };
  std::string hashes = of_one(file);
  for (const fs::path& beside : files_beside(file)) hashes += of_one(beside);
  return hashes;
}

void check_unchanged(const fs::path& file, const std::string& hash) {
  if (hash_of_input(file) != hash)
    throw Interrupted(file.string() + ": changed while it was read (run the check again)");
}

}  // namespace spherechain::baker
