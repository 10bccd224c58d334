// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/os/sha256.h"

#include <openssl/evp.h>

#include <array>
#include <fstream>
#include <sstream>

#include "baker/mesh/error.h"

namespace spherechain::baker {

std::string sha256_of_text(std::string_view text) {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned size = 0;
  if (EVP_Digest(text.data(), text.size(), digest.data(), &size, EVP_sha256(), nullptr) != 1) {
    throw Error(ExitCode::kInternal, "SHA-256 is not available in this OpenSSL");
  }
  std::string hex;
  for (unsigned i = 0; i < size; ++i) {
    constexpr char kDigits[] = "0123456789abcdef";
    hex += kDigits[digest[i] >> 4];
    hex += kDigits[digest[i] & 15];
  }
  return hex;
}

std::string sha256_of_file(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  if (!in || in.bad()) throw Error(ExitCode::kFile, path.string() + ": cannot be read");
  return sha256_of_text(bytes.view());
}

}  // namespace spherechain::baker
