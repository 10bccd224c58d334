// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/look.h"

#include <fstream>
#include <sstream>

namespace spherechain::baker {

std::string read_picture(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error) || std::filesystem::file_size(file, error) > kPictureBytesMax)
    return {};
  std::ifstream in(file, std::ios::binary);
  std::ostringstream bytes;
  bytes << in.rdbuf();
  return std::move(bytes).str();
}

std::int32_t SourceLook::add_picture(std::string bytes) {
  std::uintmax_t all = bytes.size();
  for (const std::string& picture : pictures) all += picture.size();
  if (all > 4 * kPictureBytesMax) bytes.clear();
  pictures.push_back(std::move(bytes));
  return static_cast<std::int32_t>(pictures.size() - 1);
}

}  // namespace spherechain::baker
