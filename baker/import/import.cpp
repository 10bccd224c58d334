// SPDX-License-Identifier: GPL-3.0-or-later
#include "import/import.h"

#include <algorithm>
#include <cctype>
#include <system_error>

#include "import/gltf_file.h"
#include "import/obj_file.h"
#include "import/sha256.h"
#include "mesh/error.h"

namespace spherechain::baker {
namespace {

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

// Through assimp a glTF would lose its own vertex order and bind pose.
bool is_gltf(const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  return extension == ".glb" || extension == ".gltf";
}

}  // namespace

void check_regular_file(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  const auto fail = [&](const std::string& what) { throw Error(ExitCode::kFile, path.string() + ": " + what); };
  if (status.type() == std::filesystem::file_type::not_found) fail("no such file");
  if (status.type() == std::filesystem::file_type::none) fail("cannot be read (" + error.message() + ")");
  if (std::filesystem::is_directory(status)) fail("is a folder, not a file");
  if (!std::filesystem::is_regular_file(status)) fail("is a pipe or a device, not a file");
}

std::vector<std::filesystem::path> files_beside(const std::filesystem::path& source) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(source, ignored)) return {};
  if (is_gltf(source)) return files_of_gltf(source);
  if (extension_of(source) == ".obj") return files_of_obj(source);
  return {};
}

std::vector<std::filesystem::path> files_read_with(const std::filesystem::path& source) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(source, ignored) || is_gltf(source)) return {};  // files_beside has a glTF's
  return files_read_with_assimp(source);
}

SourceMesh read_source(const std::filesystem::path& path, const ImportOptions& options) {
  check_regular_file(path);
  return is_gltf(path) ? read_with_tinygltf(path, options) : read_with_assimp(path);
}

Character import_character(const std::filesystem::path& path, const ImportOptions& options) {
  Character character = build_character(read_source(path, options), path.string());
  character.file = path.filename().string();
  character.sha256 = sha256_of_file(path);
  return character;
}

}  // namespace spherechain::baker
