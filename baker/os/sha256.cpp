// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/os/sha256.h"

#include <sha2.h>

#include <array>
#include <cstdint>
#include <fstream>
#include <sstream>

#include "baker/mesh/error.h"

namespace spherechain::baker {

std::string sha256_of_text(std::string_view text) {
  std::array<char, SHA256_DIGEST_STRING_LENGTH> hex{};
  SHA256Data(reinterpret_cast<const std::uint8_t*>(text.data()), text.size(), hex.data());
  return hex.data();
}

std::string sha256_of_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  if (!in || in.bad()) throw Error(ExitCode::kFile, path.string() + ": cannot be read");
  return sha256_of_text(bytes.view());
}

}  // namespace spherechain::baker
