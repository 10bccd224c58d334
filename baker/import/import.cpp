// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/import.h"

#include <system_error>

#include "import/sha256.h"
#include "mesh/error.h"

namespace spherechain::baker {

Character import_character(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw Error(ExitCode::kFile, path.string() + ": no such file");
  if (std::filesystem::is_directory(status)) throw Error(ExitCode::kFile, path.string() + ": is a folder, not a mesh");
  const std::string digest = sha256_of_file(path);
  Character character = build_character(read_with_assimp(path), path.string());
  character.file = path.filename().string();
  character.sha256 = digest;
  return character;
}

}  // namespace spherechain::baker
