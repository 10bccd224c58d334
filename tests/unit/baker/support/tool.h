// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "temporary_folder.h"

// The command line tool, run as pipelines run it.
namespace tool {

struct Run {
  int code;
  std::string out, error;
};

// By a shell: `arguments` may be quoted, and may send the output elsewhere. `environment` goes before the command.
Run run(const std::string& arguments, const std::string& environment = {});

// One line, "spherechain: error: ...", that mentions what it should.
void check_error(const Run& run, int code, const std::vector<std::string>& parts);

// Without its end.
std::string last_line(const std::string& text);

std::string contents(const std::filesystem::path& path);
std::size_t files_in(const std::filesystem::path& folder);

// The path of one of samples/poses.
std::string pose(const char* name);

// The human, baked by the tool once a run.
struct BakedFiles {
  BakedFiles();
  TemporaryFolder folder;
  std::filesystem::path asset, report;
  Run bake;
};
const BakedFiles& baked_files();

}  // namespace tool
