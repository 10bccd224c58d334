// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/check/library.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "baker/check/json_input.h"
#include "baker/import/import.h"
#include "baker/import/robot_model.h"
#include "baker/mesh/error.h"
#include "baker/mesh/utf8.h"
#include "baker/play/asset_file.h"
#include "baker/roles/roles.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;
using json = nlohmann::ordered_json;
using Motions = std::vector<LibraryCharacter::Motion>;

std::string extension_of(const fs::path& file) {
  std::string out = file.extension().string();
  if (out == ".xml" && file.stem().has_extension()) out = file.stem().extension().string() + out;  // Ogre's .mesh.xml
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

bool may_be_character(const fs::path& file) {
  static const std::set<std::string> kExtensions{
      ".glb",     ".gltf", ".vrm", ".fbx", ".dae", ".zae", ".obj", ".x",   ".ms3d", ".b3d",      ".3ds",
      ".md5mesh", ".smd",  ".iqm", ".mdl", ".md2", ".md3", ".ply", ".stl", ".mesh", ".mesh.xml", ".urdf"};
  const std::string extension = extension_of(file);
  return kExtensions.count(extension) > 0 || (extension == ".xml" && is_robot(file));
}

bool may_be_motion(const fs::path& file) {
  static const std::set<std::string> kExtensions{".bvh", ".fbx", ".glb", ".gltf", ".vrm",
                                                 ".dae", ".zae", ".npz", ".csv"};
  // AMASS has the shapes of its persons beside their motions.
  const std::string stem = file.stem().string();
  const bool is_shape = extension_of(file) == ".npz" && (stem == "shape" || stem.ends_with("_stagei"));
  return kExtensions.count(extension_of(file)) > 0 && !is_shape;
}

struct Found {
  fs::path path;
  std::string error = {};  // of a folder that cannot be read

  bool operator<(const Found& other) const { return path < other.path; }
};

using Folders = std::vector<fs::path>;  // those that were looked at, as Library has them

// Lists `folder` and all below, by name; no file need be readable. Links to folders are not followed: there is no
// ring of them.
std::vector<Found> files_below(const fs::path& folder, bool (*wanted)(const fs::path&), Folders& looked_at) {
  looked_at.push_back(fs::weakly_canonical(folder));
  std::vector<Found> out;
  std::vector<fs::path> folders{folder};
  while (!folders.empty()) {
    const fs::path at = std::move(folders.back());
    folders.pop_back();
    std::error_code error, ignored;
    for (fs::directory_iterator entry(at, error), end; !error && entry != end; entry.increment(error)) {
      const fs::file_status own = entry->symlink_status(ignored);
      if (fs::is_directory(own)) {
        folders.push_back(entry->path());
      } else if (wanted(entry->path()) && !entry->is_directory(ignored)) {
        out.push_back({entry->path()});
      }
    }
    if (error) out.push_back({at, at.string() + ": cannot be read (" + error.message() + ")"});
  }
  std::sort(out.begin(), out.end());
  return out;
}

void check_there(const fs::path& path) {
  std::error_code ignored;
  if (!fs::exists(path, ignored)) throw Error(ExitCode::kFile, path.string() + ": there is no such file or folder");
}

Motions motions_at(const fs::path& path, Folders& looked_at) {
  check_there(path);
  if (!fs::is_directory(path)) return {{as_utf8(path.filename().string()), path}};
  Motions out;
  for (const Found& found : files_below(path, may_be_motion, looked_at))
    out.push_back({as_utf8(found.path.lexically_relative(path).string()), found.path, found.error});
  if (out.empty())
    throw Error(ExitCode::kFile, path.string() + ": has no recordings (BVH, FBX, glTF, Collada, .npz or CSV)");
  return out;
}

void append(Motions& to, const Motions& from) { to.insert(to.end(), from.begin(), from.end()); }

class Manifest {
 public:
  Manifest(const fs::path& file, Folders& looked_at)
      : file_(file), folder_(file.parent_path()), looked_at_(looked_at) {}

  std::vector<LibraryCharacter> read(const CheckConfig& config) const {
    constexpr const char* kRefusal = "is not a manifest (an object with a list 'characters')";
    const json manifest = parse_input(read_file(file_.string()), file_.string(), kRefusal);
    if (!manifest.is_object() || !manifest.contains("characters") || !manifest["characters"].is_array()) {
      fail(kRefusal);
    }
    check_keys(manifest, {"characters", "motions"}, {});
    const Motions shared = motions_of(manifest, {});
    std::vector<LibraryCharacter> out;
    for (const json& entry : manifest["characters"]) {
      const std::string place = fmt::format("'characters', entry {}", out.size() + 1);
      out.push_back(character(entry.is_string() ? json{{"file", entry}} : entry, config, place));
      append(out.back().motions, shared);
    }
    return out;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw Error(ExitCode::kFile, file_.string() + ": " + what); }

  // `place`: "'characters', entry 2: ", or empty.
  void check_keys(const json& object, const std::set<std::string>& known, const std::string& place) const {
    for (const auto& [key, value] : object.items()) {
      if (known.count(key) == 0) fail(place + "'" + key + "' is unknown");
    }
  }

  // Paths are relative to the manifest.
  fs::path path(const json& value, const std::string& place, const char* key) const {
    if (!value.is_string()) fail(place + "'" + key + "' is not a path");
    return folder_ / value.get<std::string>();
  }

  Motions motions_of(const json& object, const std::string& place) const {
    Motions out;
    if (!object.contains("motions")) return out;
    if (!object["motions"].is_array()) fail(place + "'motions' is not a list of paths");
    for (const json& entry : object["motions"]) append(out, motions_at(path(entry, place, "motions"), looked_at_));
    return out;
  }

  LibraryCharacter character(const json& entry, const CheckConfig& config, const std::string& where) const {
    const std::string place = where + ": ";
    if (!entry.is_object() || !entry.contains("file")) fail(place + "a character has no 'file'");
    check_keys(entry, {"file", "motions", "roles", "config"}, place);
    LibraryCharacter out{{}, path(entry["file"], place, "file"), motions_of(entry, place), config, {}};
    out.relative = out.file.lexically_relative(folder_).lexically_normal();
    if (out.relative.empty() || *out.relative.begin() == "..") out.relative = out.file.filename();
    if (entry.contains("config"))
      out.config = read_config(entry["config"].dump(), file_.string(), config, place + "'config'");
    if (entry.contains("roles")) {
      const std::string roles = path(entry["roles"], place, "roles").string();
      out.config.bake.roles = parse_role_file(read_file(roles), roles);
    }
    return out;
  }

  fs::path file_, folder_;
  Folders& looked_at_;
};

// Links of robots are no characters.
void remove_links(std::vector<LibraryCharacter>& characters) {
  std::set<fs::path> links;
  for (const LibraryCharacter& one : characters) {
    if (!is_robot(one.file)) continue;
    for (const fs::path& file : files_read_with(one.file)) links.insert(fs::weakly_canonical(file));
  }
  std::erase_if(characters,
                [&](const LibraryCharacter& one) { return links.contains(fs::weakly_canonical(one.file)); });
}

// The shortest ends of the paths that are all different.
void give_names(std::vector<LibraryCharacter>& characters) {
  const auto tail = [](const fs::path& path, int parts) {
    fs::path out, rest = path;
    for (int i = 0; i < parts && rest.has_filename(); ++i, rest = rest.parent_path()) out = rest.filename() / out;
    const std::string text = as_utf8(out.string());
    return text.substr(0, text.find_last_not_of('/') + 1);
  };
  for (int parts = 1; parts < 16; ++parts) {
    std::map<std::string, int> count;
    for (const LibraryCharacter& c : characters) ++count[tail(fs::absolute(c.file), parts)];
    for (LibraryCharacter& c : characters) {
      const std::string text = tail(fs::absolute(c.file), parts);
      if (c.name.empty() && count[text] == 1) c.name = text;
    }
  }
  std::map<std::string, int> seen;  // one file that is given twice
  for (LibraryCharacter& c : characters) {
    if (!c.name.empty()) continue;
    c.name = as_utf8(c.file.filename().string());
    if (const int n = ++seen[c.file.string()]; n > 1) c.name += " (" + std::to_string(n) + ")";
  }
}

}  // namespace

Library read_library(const std::vector<std::string>& paths, const std::string& motion, const CheckConfig& config) {
  Library library;
  std::vector<LibraryCharacter>& out = library.characters;
  for (const std::string& path : paths) {
    check_there(path);
    if (extension_of(path) == ".json") {
      const std::vector<LibraryCharacter> all = Manifest(path, library.folders).read(config);
      out.insert(out.end(), all.begin(), all.end());
    } else if (fs::is_directory(path)) {
      std::vector<LibraryCharacter> all;
      for (const Found& found : files_below(path, may_be_character, library.folders))
        all.push_back({{}, found.path, {}, config, found.path.lexically_relative(path), found.error});
      remove_links(all);
      out.insert(out.end(), all.begin(), all.end());
    } else {
      out.push_back({{}, path, {}, config, fs::path(path).filename()});
    }
  }
  // A folder of recordings may lie within that of the characters.
  if (!motion.empty() && fs::is_directory(motion)) {
    const fs::path folder = fs::weakly_canonical(motion);
    std::erase_if(out, [&](const LibraryCharacter& character) {
      const fs::path inside = fs::weakly_canonical(character.file).lexically_relative(folder);
      return !inside.empty() && *inside.begin() != "..";
    });
  }
  if (out.empty())
    throw Error(ExitCode::kFile,
                paths.front() + ": has no characters (docs/cli/check.md lists the endings that are searched for)");
  if (!motion.empty()) {
    const Motions shared = motions_at(motion, library.folders);
    for (LibraryCharacter& character : out) {
      // In a folder, CSV files are for robots and all others for other characters.
      const bool takes_csv = is_robot(character.file);
      for (const LibraryCharacter::Motion& one : shared) {
        if (!fs::is_directory(motion) || (extension_of(one.file) == ".csv") == takes_csv)
          character.motions.push_back(one);
      }
    }
  }
  give_names(out);
  return library;
}

}  // namespace spherechain::baker
