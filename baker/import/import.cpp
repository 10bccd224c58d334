// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/import/import.h"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <system_error>

#include "baker/import/archive.h"
#include "baker/import/array_character.h"
#include "baker/import/arrays.h"
#include "baker/import/assimp_glb.h"
#include "baker/import/glb_file.h"
#include "baker/import/gltf_file.h"
#include "baker/import/notes.h"
#include "baker/import/obj_file.h"
#include "baker/import/read_bvh.h"
#include "baker/import/read_in_child.h"
#include "baker/import/robot_model.h"
#include "baker/import/robot_motion.h"
#include "baker/import/smpl_motion.h"
#include "baker/mesh/error.h"
#include "baker/os/access.h"
#include "baker/os/sha256.h"

namespace spherechain::baker {
namespace {

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

// A glTF is recognised by its first bytes, whatever its ending (a .vrm is a GLB). No other format begins with a JSON
// object. Through assimp a glTF would lose its own vertex order and bind pose.
bool is_gltf(const std::filesystem::path& path) {
  std::string start(64, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(file.gcount()));
  if (start.starts_with("\xEF\xBB\xBF")) start.erase(0, 3);
  const std::size_t first = start.find_first_not_of(" \t\r\n");
  return start.starts_with("glTF") || (first != start.npos && start[first] == '{');
}

constexpr const char* kNoMesh = ": is a recording without a mesh (name it by --motion)";

// One bone moves all vertices. Morph targets stay at their weights at rest.
void make_rigid(SourceMesh& mesh) {
  for (const Morph& morph : mesh.rig.morphs) {
    for (std::size_t i = 0; i < morph.vertices.size(); ++i) {
      mesh.positions[morph.vertices[i]] += morph.rest_weight * morph.deltas[i];
    }
  }
  mesh.bones_dropped = mesh.rig.bones.size();
  Node node;
  node.name = kPropBone;
  VertexWeights whole;
  whole.weight[0] = 1;
  mesh.rig = {};
  mesh.rig.nodes = {node};
  mesh.rig.bones = {{0, Affine::Identity()}};
  mesh.rig.weights.assign(mesh.positions.size(), whole);
}

SourceMesh read_with_numpy(const std::filesystem::path& path) {
  const Arrays arrays = read_arrays(path);
  if (auto character = array_character(arrays, path.string())) return std::move(*character);
  SourceMesh mesh;
  mesh.importer = "numpy";
  if (auto motion = smpl_motion(arrays, path.string())) {
    mesh.rig = std::move(*motion);
    return mesh;
  }
  if (robot_motion(arrays, path.string())) {
    throw Error(ExitCode::kFile,
                path.string() + ": is the motion of a robot (play it on that robot: a URDF or MJCF file)");
  }
  std::string names;
  for (const auto& [name, array] : arrays) {
    constexpr std::size_t kShown = 200;
    if (names.size() < kShown) names += (names.empty() ? "'" : ", '") + name + "'";
  }
  throw Error(ExitCode::kFile, path.string() + ": holds neither a motion nor a character, only " + names +
                                   " (docs/formats.md has the names that are read)");
}

// A mesh that the child process sends, with its notes.
struct NotedMesh {
  SourceMesh mesh;
  std::vector<std::string> notes;
};
void members(auto& io, Is<NotedMesh> auto& m) { io(m.mesh, m.notes); }

// Control characters in names (a zero would end them early in an asset) are shown as what is no character.
void clean(std::string& name) {
  std::string out;
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7F)
      out += "\xEF\xBF\xBD";
    else
      out += c;
  }
  name = std::move(out);
}

void clean_names(SourceMesh& mesh) {
  for (SourceBuffer& buffer : mesh.buffers) clean(buffer.name);
  for (Node& node : mesh.rig.nodes) clean(node.name);
  for (Morph& morph : mesh.rig.morphs) clean(morph.name);
  for (Clip& clip : mesh.rig.clips) clean(clip.name);
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
  if (const std::error_code failure = check_readable(path)) fail("cannot be read (" + failure.message() + ")");
}

std::vector<std::filesystem::path> files_beside(const std::filesystem::path& source) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(source, ignored)) return {};
  if (is_gltf(source)) return files_of_gltf(source);
  if (is_robot(source)) return files_read_with(source);
  if (extension_of(source) == ".obj") return files_of_obj(source);
  return {};
}

std::vector<std::filesystem::path> files_read_with(const std::filesystem::path& source) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(source, ignored)) return {};
  if (is_gltf(source) || is_recording(source) || is_arrays(source)) return {};  // files_beside has a glTF's
  try {
    const auto files = from_bytes<std::vector<std::string>>(read_in_child(source.string(), [&] {
      return to_bytes(is_robot(source) ? files_of_robot(source) : files_read_with_assimp(source));
    }));
    return {files.begin(), files.end()};
  } catch (const Error&) {  // which read_source says
    return {};
  }
}

SourceMesh read_source(const std::filesystem::path& path, const ImportOptions& options) {
  check_regular_file(path);
  std::error_code ignored;
  if (std::filesystem::file_size(path, ignored) == 0) {
    throw Error(ExitCode::kFile, path.string() + ": is empty (export it again)");
  }
  SourceMesh mesh;
  if (is_recording(path) && !is_gltf(path)) {
    mesh.importer = "bvh";
    mesh.rig = read_bvh(path);
  } else {
    auto received = from_bytes<NotedMesh>(read_in_child(path.string(), [&] {
      take_notes();  // the parent's
      NotedMesh read{is_gltf(path)     ? read_with_tinygltf(path, options)
                     : is_robot(path)  ? read_robot(path, options)
                     : is_arrays(path) ? read_with_numpy(path)
                                       : read_with_assimp(path, options),
                     {}};
      read.notes = take_notes();
      return to_bytes(read);
    }));
    for (const std::string& note : received.notes) add_note(note);
    mesh = std::move(received.mesh);
  }
  clean_names(mesh);
  if (options.prop) make_rigid(mesh);
  return mesh;
}

std::string read_as_glb(const std::filesystem::path& path) {
  check_regular_file(path);
  if (is_recording(path) && !is_gltf(path)) {
    throw Error(ExitCode::kFile, path.string() + kNoMesh);
  }
  refuse_robot(path);
  return read_in_child(path.string(), [&] {
    if (is_gltf(path)) return pack_gltf(path);
    if (!is_arrays(path)) return glb_with_assimp(path);
    const SourceMesh mesh = read_with_numpy(path);
    if (mesh.triangles.empty()) throw Error(ExitCode::kFile, path.string() + kNoMesh);
    return glb_of(mesh);
  });
}

Character import_character(const std::filesystem::path& path, const ImportOptions& options) {
  Character character = build_character(read_source(path, options), path.string());
  character.file = path.filename().string();
  character.sha256 = sha256_of_file(path);
  return character;
}

}  // namespace spherechain::baker
