// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace spherechain::baker {

struct MotionChoice;

// What a command asks of its files before the work that takes seconds.

// A file that a command reads or writes, by the name that the usage has for it ("INPUT", "--report"). An empty path
// stands for an option that was not given.
struct CommandFile {
  const char* name;
  std::string path;
  bool is_mesh = false;  // or motion: an importer reads it, with files of the importer's choice
};

// `inputs`, a source of that name, and the files that it names in turn.
std::vector<CommandFile> with_source(std::vector<CommandFile> inputs, const char* name, const std::string& source);

// `inputs` and what a motion is read from: its file, or each mesh of its sequence, and the files that those name in
// turn. Throws Error(kFile) where a sequence has none.
std::vector<CommandFile> with_motion(std::vector<CommandFile> inputs, const MotionChoice& motion);

// No output is an input, a file that a mesh is read with, or another output, under whatever name or link: Error(kUsage)
// that names both. Each output's folder is there and writable: Error(kFile). Where an output is there already, and not
// of this tool's making, the meshes are read for it.
void check_outputs(const std::vector<CommandFile>& inputs, const std::vector<CommandFile>& outputs);

// Nothing is lost to a slip: a file that is there already is of the same kind (its bytes from `offset` on are `magic`,
// letters' case aside), or empty, or `force` is given. Throws Error(kFile).
void check_replaceable(const std::string& file, std::string_view magic, const std::string& kind, bool force,
                       std::size_t offset = 0);

// The same for a report or a table in JSON: one of those that this tool writes. `advice` says what to do else.
void check_replaceable_json(const std::string& file, bool force, const std::string& advice);

}  // namespace spherechain::baker
