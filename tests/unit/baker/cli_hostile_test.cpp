// SPDX-License-Identifier: GPL-3.0-or-later
// What a command line, a disk and a user's files may do to the tool: never an internal error.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "human.h"
#include "temporary_folder.h"
#include "tool.h"

namespace fs = std::filesystem;

namespace {

using tool::baked_files;
using tool::check_error;
using tool::contents;
using tool::run;

}  // namespace

TEST_CASE("numbers that are none are usage errors") {
  const TemporaryFolder folder;
  for (const char* number : {"--fps nan", "--fps -nan", "--fps inf", "--fps 0", "--fps -1", "--fps 1e7", "--fps ten",
                             "--frames nan", "--frames -1", "--frames 1.5", "--frames 99999999999999999999"}) {
    CAPTURE(number);
    check_error(run(fmt::format("view {} --source {} -o {}/page.html {}", baked_files().asset.string(), kHumanFile,
                                folder.path.string(), number)),
                2, {std::string(number).substr(0, 5)});
  }
  CHECK(tool::files_in(folder.path) == 0);
}

TEST_CASE("a file's name need not be UTF-8, the JSON about it is") {
  const TemporaryFolder folder;
  const fs::path source = folder.path / "caf\xe9.zae", asset = folder.path / "caf\xe9.sphc";
  fs::copy(kHumanFile, source);
  const fs::path report = folder.path / "report\xe9.json", play = folder.path / "play.json",
                 validation = folder.path / "validation.json";
  const tool::Run bake =
      run(fmt::format("bake {} -o {} --report {}", source.string(), asset.string(), report.string()));
  REQUIRE_MESSAGE(bake.code == 0, bake.error);
  CHECK(nlohmann::json::parse(contents(report))["source"]["file"] == "caf\xef\xbf\xbd.zae");
  for (const auto& [command, file] : {std::pair("play", &play), std::pair("validate", &validation)}) {
    const tool::Run done = run(
        fmt::format("{} {} --source {} --frames 1 --json {}", command, asset.string(), source.string(), file->string()),
        "SPHERECHAIN_CACHE=off");
    CHECK_MESSAGE(done.code == 0, done.error);
    CHECK(nlohmann::json::accept(contents(*file)));
  }
}

TEST_CASE("settings that no settings are end with 3: numbers past the largest, objects without end") {
  const TemporaryFolder folder;
  const auto bake_with = [&](const std::string& text) {
    return run(fmt::format("bake {} -o {}/out.sphc --config {}", kHumanFile, folder.path.string(),
                           folder.write("c.json", text).string()));
  };
  check_error(bake_with(R"({"delta": 1e400})"), 3, {"c.json", "1e400"});
  std::string deep;
  for (int i = 0; i < 300000; ++i) deep += R"({"roles":)";
  check_error(bake_with(deep + "1" + std::string(300000, '}')), 3, {"c.json", "nested"});
  std::string lists = R"({"facing":)" + std::string(300000, '[') + std::string(300000, ']') + "}";
  check_error(bake_with(lists), 3, {"c.json", "nested"});
  CHECK(!fs::exists(folder.path / "out.sphc"));
}

TEST_CASE("what is printed and cannot be written ends with 3") {
  const TemporaryFolder folder;
  check_error(run(fmt::format("inspect {} --json >/dev/full", baked_files().asset.string())), 3, {"standard output"});
  check_error(run(fmt::format("inspect {} >/dev/full", baked_files().asset.string())), 3, {"standard output"});
  check_error(run("--version >/dev/full"), 3, {"standard output"});
  check_error(run(fmt::format("play {} --source {} --frames 1 >/dev/full", baked_files().asset.string(), kHumanFile)),
              3, {"standard output"});
  check_error(run(fmt::format("bake {} -o {}/o.sphc >/dev/full", kHumanFile, folder.path.string())), 3,
              {"standard output"});
}
