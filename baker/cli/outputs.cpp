// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/cli/outputs.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "baker/mesh/error.h"
#include "baker/motion/poses.h"
#include "baker/motion/sequence.h"
#include "baker/os/access.h"
#include "baker/os/written_file.h"
#include "baker/play/play.h"

namespace spherechain::baker {
namespace {

namespace fs = std::filesystem;

// Checks the folder of `place`, the path that `file` leads to.
void check_folder(const std::string& file, const fs::path& place) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) throw Error(ExitCode::kFile, file + ": cannot be written (it is a folder)");
  if (is_written_directly(file)) return;
  const std::error_code failure = fs::exists(place, ignored) ? check_writable(place) : std::error_code();
  if (failure) throw Error(ExitCode::kFile, file + ": cannot be replaced (" + failure.message() + ")");
  const fs::path folder = fs::absolute(place, ignored).parent_path();
  if (!fs::is_directory(folder, ignored)) {
    throw Error(ExitCode::kFile, file + ": cannot be created (there is no folder " + folder.string() + ")");
  }
  if (check_writable(folder)) {
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

void check_other(const char* other, const fs::path& path, const OutputFile& output, const fs::path& place) {
  if (!same_file(path, place)) return;
  throw Error(ExitCode::kUsage,
              output.path + ": " + other + " and " + output.name + " are the same file (name another)");
}

bool has_no_bytes(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored) && fs::file_size(file, ignored) == 0;
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

void check_outputs(const std::vector<CommandFile>& inputs, const std::vector<OutputFile>& outputs, Force force) {
  std::vector<CommandFile> others = inputs;
  std::vector<OutputFile> foreign, may_be_read;
  for (const OutputFile& output : outputs) {
    if (output.path.empty()) continue;
    const fs::path place = written_file(output.path);
    check_folder(output.path, place);
    for (const CommandFile& other : others) {
      if (!other.path.empty()) check_other(other.name, other.path, output, place);
    }
    others.push_back({output.name, place.string()});
    const bool is_own = is_own_file(place, output.kind, output.copy_of);
    if (!is_own) foreign.push_back(output);
    if (!is_own || has_no_bytes(place)) may_be_read.push_back(output);
  }
  // To know what meshes are read with takes as long as reading them: not for what is made again and again.
  if (may_be_read.empty()) return;
  for (const CommandFile& input : inputs) {
    if (!input.is_mesh) continue;
    for (const fs::path& file : files_read_with(input.path)) {
      for (const OutputFile& output : may_be_read) check_other(input.name, file, output, written_file(output.path));
    }
  }
  if (foreign.empty() || force == Force::kGiven) return;
  throw Error(ExitCode::kFile, foreign.front().path + ": exists and is not " + kind_text(foreign.front().kind) +
                                   " that spherechain wrote (" +
                                   (force == Force::kOffered ? "--force replaces it" : "move it, or name another") +
                                   ")");
}

bool has_ending(const std::string& file, const char* ending) {
  std::string own = std::filesystem::path(file).extension().string();
  for (char& c : own) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return own == ending;
}

}  // namespace spherechain::baker
