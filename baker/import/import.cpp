// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/import.h"

#include <algorithm>
#include <cctype>
#include <system_error>

#include "import/sha256.h"
#include "mesh/error.h"

namespace spherechain::baker {

SourceMesh read_source(const std::filesystem::path& path, const ImportOptions& options) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw Error(ExitCode::kFile, path.string() + ": no such file");
  if (std::filesystem::is_directory(status)) throw Error(ExitCode::kFile, path.string() + ": is a folder, not a mesh");
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  // Through assimp a glTF would lose its own vertex order and bind pose.
  const bool gltf = extension == ".glb" || extension == ".gltf";
  return gltf ? read_with_tinygltf(path, options) : read_with_assimp(path);
}

Character import_character(const std::filesystem::path& path, const ImportOptions& options) {
  Character character = build_character(read_source(path, options), path.string());
  character.file = path.filename().string();
  character.sha256 = sha256_of_file(path);
  return character;
}

}  // namespace spherechain::baker
