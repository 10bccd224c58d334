// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/outputs.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>

#include "mesh/error.h"
#include "motion/poses.h"
#include "motion/sequence.h"
#include "play/play.h"
#include "write/write.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

// Of `place`, where `file` leads.
void check_folder(const std::string& file, const fs::path& place) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) throw Error(ExitCode::kFile, file + ": cannot be written (it is a folder)");
  if (is_written_directly(file)) return;
  const fs::path folder = fs::absolute(place, ignored).parent_path();
  if (!fs::is_directory(folder, ignored)) {
    throw Error(ExitCode::kFile, file + ": cannot be created (there is no folder " + folder.string() + ")");
  }
  if (::access(folder.c_str(), W_OK) != 0) {
    throw Error(ExitCode::kFile, file + ": cannot be created (the folder " + folder.string() + " is not writable)");
  }
}

bool same_file(const fs::path& a, const fs::path& b) {
  std::error_code error;
  if (fs::equivalent(a, b, error)) return true;
  // One that is not there yet has no other mark than its place; a relative path of which nothing is there stays
  // relative in weakly_canonical.
  const fs::path place_a = fs::weakly_canonical(fs::absolute(a, error), error);
  if (error) return false;
  const fs::path place_b = fs::weakly_canonical(fs::absolute(b, error), error);
  return !error && place_a == place_b;
}

void check_other(const char* other, const fs::path& path, const CommandFile& output, const fs::path& place) {
  if (!same_file(path, place)) return;
  throw Error(ExitCode::kUsage,
              output.path + ": " + other + " and " + output.name + " are the same file (name another)");
}

// Does `file` hold `magic` at `offset`? So does an empty file, and one that is not there.
bool begins_with(const std::string& file, std::string_view magic, std::size_t offset) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored) || fs::file_size(file, ignored) == 0) return true;
  std::string there(offset + magic.size(), '\0');
  std::ifstream(file, std::ios::binary).read(there.data(), static_cast<std::streamsize>(there.size()));
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
  };
  return std::equal(magic.begin(), magic.end(), there.begin() + static_cast<std::ptrdiff_t>(offset), same);
}

// Whether it is what play --json, validate --json, bake --report, check, filter or fix wrote: by the first keys of
// these.
bool begins_as_table(const std::string& file) {
  for (const char* start :
       {"{\n \"backend\":", "{\n \"frames\":", "{\n \"writer\":", "{\n \"summary\":", "{\n \"clips\":",
        "{\n \"$schema\":", "{\n \"spherechain_baseline\":", "{\n \"spherechain\":"}) {
    if (begins_with(file, start, 0)) return true;
  }
  return false;
}

// Whether there is a file that a mesh may be read with: not what this tool writes for itself.
bool may_be_read(const fs::path& file) {
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) return false;
  const std::string name = file.string();
  return fs::file_size(file, ignored) == 0 ||
         !(begins_with(name, "SPHC", 4) || begins_with(name, "<!doctype html", 0) || begins_as_table(name));
}

using Files = std::vector<fs::path>;

void add(std::vector<CommandFile>& inputs, const char* name, const Files& files) {
  for (const fs::path& file : files) inputs.push_back({name, file.string()});
}

void add_mesh(std::vector<CommandFile>& inputs, const char* name, const fs::path& mesh) {
  inputs.push_back({name, mesh.string(), true});
  add(inputs, name, files_beside(mesh));
}

void add_sequence(std::vector<CommandFile>& inputs, const char* name, const std::string& path) {
  inputs.push_back({name, path});
  for (const fs::path& mesh : sequence_files(path)) add_mesh(inputs, name, mesh);
}

}  // namespace

std::vector<CommandFile> with_source(std::vector<CommandFile> inputs, const char* name, const std::string& source) {
  add_mesh(inputs, name, source);
  return inputs;
}

std::vector<CommandFile> with_motion(std::vector<CommandFile> inputs, const MotionChoice& motion) {
  if (is_sequence(motion.poses)) {
    add_sequence(inputs, "--poses", motion.poses);
  } else if (!motion.poses.empty()) {
    inputs.push_back({"--poses", motion.poses});
    add(inputs, "--poses", files_of_poses(motion.poses));
  }
  if (is_sequence(motion.motion)) {
    add_sequence(inputs, "--motion", motion.motion);
  } else if (!motion.motion.empty()) {
    add_mesh(inputs, "--motion", motion.motion);
  }
  return inputs;
}

void check_outputs(const std::vector<CommandFile>& inputs, const std::vector<CommandFile>& outputs) {
  std::vector<CommandFile> others = inputs, replaced;
  for (const CommandFile& output : outputs) {
    if (output.path.empty()) continue;
    const fs::path place = written_file(output.path);
    check_folder(output.path, place);
    for (const CommandFile& other : others) {
      if (!other.path.empty()) check_other(other.name, other.path, output, place);
    }
    others.push_back({output.name, place.string()});
    if (may_be_read(place)) replaced.push_back(output);
  }
  // To know what meshes are read with takes as long as reading them: not for what is made again and again.
  if (replaced.empty()) return;
  for (const CommandFile& input : inputs) {
    if (!input.is_mesh) continue;
    for (const fs::path& file : files_read_with(input.path)) {
      for (const CommandFile& output : replaced) check_other(input.name, file, output, written_file(output.path));
    }
  }
}

void check_replaceable(const std::string& file, std::string_view magic, const std::string& kind, bool force,
                       std::size_t offset) {
  if (force || begins_with(file, magic, offset)) return;
  throw Error(ExitCode::kFile, file + ": exists and is not " + kind + " (--force replaces it)");
}

void check_replaceable_json(const std::string& file, bool force, const std::string& advice) {
  if (force || begins_as_table(file)) return;
  throw Error(ExitCode::kFile, file + ": exists and is not what spherechain writes there (" + advice + ")");
}

}  // namespace spherechain::baker
