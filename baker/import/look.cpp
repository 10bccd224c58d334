// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/look.h"

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

std::string type_of_picture(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1A\n")) return "image/png";
  if (bytes.starts_with("\xFF\xD8\xFF")) return "image/jpeg";
  if (bytes.starts_with("RIFF") && bytes.substr(0, 12).ends_with("WEBP")) return "image/webp";
  if (bytes.starts_with("\xABKTX 20\xBB")) return "image/ktx2";
  return {};
}

std::int32_t SourceLook::add_picture(std::string bytes) {
  std::uintmax_t all = bytes.size();
  for (const std::string& picture : pictures) all += picture.size();
  if (all > 4 * kPictureBytesMax) bytes.clear();
  pictures.push_back(std::move(bytes));
  return static_cast<std::int32_t>(pictures.size() - 1);
}

}  // namespace spherechain::baker
