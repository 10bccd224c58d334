// SPDX-License-Identifier: GPL-3.0-or-later
#include "tool.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <regex>

#include "human.h"

namespace tool {

namespace fs = std::filesystem;

std::string contents(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

Run run(const std::string& arguments, const std::string& environment) {
  const TemporaryFolder folder;
  const fs::path out = folder.path / "out", error = folder.path / "error";
  // Redirections first, so that those in `arguments` go before them.
  const int status = std::system(
      fmt::format(">{} 2>{} {} {} {}", out.string(), error.string(), environment, SPHERECHAIN_TOOL, arguments).c_str());
  // On a busy machine a command takes more than ten seconds, and says how far it is.
  static const std::regex kProgress(
      "spherechain: ((bake|check|export|filter|fix|mask|play|validate|view)[: ]|[^\n]*: between frames:)[^\n]*\n");
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(out),
          std::regex_replace(contents(error), kProgress, "")};
}

void check_error(const Run& run, int code, const std::vector<std::string>& parts) {
  CHECK_MESSAGE(run.code == code, run.error);
  CHECK(run.error.rfind("spherechain: error: ", 0) == 0);
  CHECK(std::count(run.error.begin(), run.error.end(), '\n') == 1);
  for (const std::string& part : parts) CHECK_MESSAGE(run.error.find(part) != std::string::npos, run.error);
}

std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of('\n') + 1, start = text.rfind('\n', end - 1) + 1;
  return text.substr(start, end - start);
}

std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

std::string pose(const char* name) { return std::string(SPHERECHAIN_SAMPLES) + "/poses/" + name; }

BakedFiles::BakedFiles()
    : asset(folder.path / "human.sphc"),
      report(folder.path / "report.json"),
      bake(run(fmt::format("bake {} -o {} --report {}", kHumanFile, asset.string(), report.string()))) {}

const BakedFiles& baked_files() {
  static const BakedFiles files;
  return files;
}

}  // namespace tool
