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

using Files = std::vector<fs::path>;

void add(std::vector<CommandFile>& inputs, const char* name, const Files& files) {
  for (const fs::path& file : files) inputs.push_back({name, file.string()});
}

// `own_files` says what a mesh, or what the motion is in one file, is made of besides.
void add_motion(std::vector<CommandFile>& inputs, const char* name, const std::string& path,
                Files (*own_files)(const fs::path&)) {
  if (path.empty()) return;
  inputs.push_back({name, path});
  if (!is_sequence(path)) return add(inputs, name, own_files(path));
  for (const fs::path& mesh : sequence_files(path)) {
    inputs.push_back({name, mesh.string()});
    add(inputs, name, files_beside(mesh));
  }
}

}  // namespace

std::vector<CommandFile> with_source(std::vector<CommandFile> inputs, const char* name, const std::string& source) {
  inputs.push_back({name, source});
  add(inputs, name, files_beside(source));
  return inputs;
}

std::vector<CommandFile> with_motion(std::vector<CommandFile> inputs, const MotionChoice& motion) {
  add_motion(inputs, "--poses", motion.poses, files_of_poses);
  add_motion(inputs, "--motion", motion.motion, files_beside);
  return inputs;
}

void check_outputs(const std::vector<CommandFile>& inputs, const std::vector<CommandFile>& outputs) {
  std::vector<CommandFile> others = inputs;
  for (const CommandFile& output : outputs) {
    if (output.path.empty()) continue;
    const fs::path place = written_file(output.path);
    check_folder(output.path, place);
    for (const CommandFile& other : others) {
      if (!other.path.empty() && same_file(other.path, place)) {
        throw Error(ExitCode::kUsage,
                    output.path + ": " + other.name + " and " + output.name + " are the same file (name another)");
      }
    }
    others.push_back({output.name, place.string()});
  }
}

void check_replaceable(const std::string& file, std::string_view magic, const std::string& kind, bool force,
                       std::size_t offset) {
  if (force || begins_with(file, magic, offset)) return;
  throw Error(ExitCode::kFile, file + ": exists and is not " + kind + " (--force replaces it)");
}

void check_replaceable_json(const std::string& file, bool force, const std::string& advice) {
  if (force) return;
  // The first key of what bake --report, play --json and validate --json write.
  for (const char* start : {"{\n \"writer\":", "{\n \"backend\":", "{\n \"frames\":"}) {
    if (begins_with(file, start, 0)) return;
  }
  throw Error(ExitCode::kFile, file + ": exists and is not what spherechain writes there (" + advice + ")");
}

}  // namespace spherechain::baker
