// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/write/own_file.h"

namespace spherechain::baker {

struct MotionChoice;

// Checks that a command makes on its files before the work that takes seconds.

// A file that a command reads, by the name that the usage has for it ("INPUT", "--config"). An empty path
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

// A file that a command writes.
struct OutputFile {
  const char* name;
  std::string path;
  FileKind kind;
  std::string copy_of = {};  // a file with the same bytes is no loss either
};

// True if the command has --force: it may replace files that this tool did not write.
enum class Force { kNone, kOffered, kGiven };

// The rule of every output of every command (docs/cli/README.md). No output is an input, a file that a mesh is read
// with, or another output, under whatever name or link: Error(kUsage) that names both. Each output's folder is there
// and writable, and a file that is there already is empty or this tool's, of the same kind: Error(kFile).
void check_outputs(const std::vector<CommandFile>& inputs, const std::vector<OutputFile>& outputs, Force force);

// Does a file's name end so, in upper or lower case? `ending` is in lower case, with its dot.
bool has_ending(const std::string& file, const char* ending);

}  // namespace spherechain::baker
