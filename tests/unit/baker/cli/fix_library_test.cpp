// SPDX-License-Identifier: GPL-3.0-or-later
// `spherechain check --fix`: the characters of a library that have faults, mended into a folder.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "temporary_folder.h"
#include "tool.h"
#include "wall_and_arm.h"

using nlohmann::json;
namespace fs = std::filesystem;

namespace {

const std::vector<double> kFaulty(30, 5), kClean(30, -10);

struct FixedLibrary {
  TemporaryFolder folder;
  fs::path mended = folder.path / "mended";
  FixedLibrary() {
    fs::create_directories(folder.path / "lib/sub");
    folder.write("lib/clean.glb", wall_and_arm(kClean));
    folder.write("lib/sub/hero.glb", wall_and_arm(kFaulty));
  }
  tool::Run check(const std::string& more, const std::string& to = "mended") const {
    return tool::run("check " + (folder.path / "lib").string() + " -o " + (folder.path / "report").string() +
                     " --cache " + (folder.path / "cache").string() + " --fix " + (folder.path / to).string() + " " +
                     more);
  }
};

}  // namespace

TEST_CASE("check --fix mends the characters with faults, and says what kept it from another") {
  const FixedLibrary library;
  // The same as hero.glb, in two files. And a place where nothing can be written.
  const std::string glb = wall_and_arm(kFaulty);
  json text = json_of(glb);
  text["buffers"][0]["uri"] = "loose.bin";
  std::uint32_t size = 0;
  std::memcpy(&size, glb.data() + 12, 4);
  library.folder.write("lib/loose.bin", glb.substr(20 + size + 8));
  library.folder.write("lib/loose.gltf", text.dump());
  fs::create_directories(library.folder.path / "lib/blocked");
  library.folder.write("lib/blocked/arm.glb", glb);
  fs::create_directories(library.mended);
  library.folder.write("mended/blocked", "a file");
  const tool::Run run = library.check("");
  CHECK_MESSAGE(run.code == 6, run.error);  // the library is as it was
  CHECK(run.out.find("not mended " + (library.folder.path / "lib/blocked/arm.glb").string()) != std::string::npos);
  CHECK(run.out.find("mended " + (library.mended / "loose.gltf.glb").string() + ": 1 clip, 1 event: 1 cleared\n") !=
        std::string::npos);
  CHECK(run.out.find("mended " + (library.mended / "sub/hero.glb").string() + ": 1 clip, 1 event: 1 cleared\n") !=
        std::string::npos);
  CHECK(!fs::exists(library.mended / "clean.glb"));
  CHECK(tool::run("check " + library.mended.string() + " -o " + (library.folder.path / "again").string()).code == 0);
  CHECK(library.check("").code == 6);  // over its own files
}

TEST_CASE("check --fix leaves what rules and baseline accept, and mends recordings as new clips" *
          doctest::test_suite("long runs")) {
  const FixedLibrary library;
  const std::string baseline = " --baseline " + (library.folder.path / "baseline.json").string();
  CHECK(library.check(baseline + " --accept").code == 0);
  CHECK(!fs::exists(library.mended));
  CHECK(library.check("--max-depth 500").code == 0);
  CHECK(!fs::exists(library.mended));
  const fs::path take = library.folder.write("take.bvh", recording_of_arm(kFaulty));
  const tool::Run run = library.check(baseline + " --motion " + take.string());
  CHECK(run.code == 6);
  const std::string clean = tool::contents(library.mended / "clean.glb"),
                    hero = tool::contents(library.mended / "sub/hero.glb");
  REQUIRE(json_of(clean)["animations"].size() == 2);
  CHECK(json_of(clean)["animations"][1]["name"] == "take");
  REQUIRE(json_of(hero)["animations"].size() == 2);
  CHECK(json_of(hero)["animations"][0] == json_of(wall_and_arm(kFaulty))["animations"][0]);
}

TEST_CASE("check --fix writes over no file of the library, and over none that is no GLB") {
  const FixedLibrary library;
  const std::string lib = (library.folder.path / "lib").string(), report = (library.folder.path / "report").string();
  tool::check_error(library.check("", "lib"), 2, {"lib: --fix is a folder of the library"});
  tool::check_error(tool::run("check " + lib + "/clean.glb -o " + report + " --fix " + lib), 2,
                    {"clean.glb", "a file of the library"});
  tool::check_error(library.check("--shard 1/2"), 2, {"--fix", "no shards"});
  fs::create_directories(library.mended / "sub");
  library.folder.write("mended/sub/hero.glb", "somebody's notes");
  tool::check_error(library.check(""), 3, {"hero.glb", "not a GLB"});
  CHECK(tool::contents(library.mended / "sub/hero.glb") == "somebody's notes");
  const std::string hero = (library.folder.path / "lib/sub/hero.glb").string();
  tool::check_error(tool::run("check " + hero + " " + hero + " -o " + (library.folder.path / "report").string() +
                              " --fix " + (library.folder.path / "other").string()),
                    2, {"hero.glb", "two characters"});
}

TEST_CASE("check writes no mended character where the next check would read it, and no cache over its inputs") {
  const FixedLibrary library;
  const auto path = [&](const char* name) { return (library.folder.path / name).string(); };
  fs::create_directories(library.folder.path / "takes");
  library.folder.write("takes/take.bvh", recording_of_arm(kFaulty));
  library.folder.write("all.json", R"({"characters": ["lib/clean.glb"], "motions": ["takes"]})");
  fs::create_directory_symlink("lib/sub", library.folder.path / "link");
  tool::check_error(library.check("", "lib/mended"), 2, {"lib/mended: --fix is inside ", "name a folder outside"});
  tool::check_error(library.check("", "link/a/b"), 2, {"link/a/b: --fix is inside "});
  tool::check_error(library.check("--motion " + path("takes"), "takes/mended"), 2, {"--fix is inside "});
  tool::check_error(tool::run("check " + path("all.json") + " -o " + path("report") + " --fix " + path("takes/x")), 2,
                    {"--fix is inside "});
  for (const char* folder : {"lib", "takes", "lib/../takes"}) {
    tool::check_error(tool::run("check " + path("lib") + " --motion " + path("takes") + " -o " + path("report") +
                                " --cache " + path(folder)),
                      2, {"--cache is a folder of the library or of recordings"});
  }
  CHECK(tool::files_in(library.folder.path / "lib") == 2);
  CHECK(tool::files_in(library.folder.path / "takes") == 1);
  CHECK(library.check("").code == 6);  // beside it
}

// Deeper than this, in mm, for the files hold single floats, and a limit may lie between two of them.
constexpr double kSameMeasure = 10;

TEST_CASE("characters of SPHERECHAIN_TEST_DATA: check finds no fault in a mended file that fix does not report" *
          doctest::skip(std::getenv("SPHERECHAIN_TEST_DATA") == nullptr)) {
  const TemporaryFolder folder;
  const auto path = [&](const char* name) { return (folder.path / name).string(); };
  const auto parts_of = [](const json& event) { return event["parts"].get<std::set<std::string>>(); };
  for (const char* file :
       {"mh_boxing.glb", "Fox.glb", "quaternius_robot.glb", "quaternius_spider.glb", "heavy/heavy_woman_boxing.glb",
        "heavy/very_heavy_man_walk.glb", "heavy/bulky_man_boxing.glb", "godette_cmu.glb"}) {
    CAPTURE(file);
    tool::run("fix " + std::string(std::getenv("SPHERECHAIN_TEST_DATA")) + "/" + file + " --force -o " +
              path("mended.glb") + " --report " + path("report"));
    tool::run("check " + path("mended.glb") + " -o " + path("check") + " --json " + path("check.json"));
    const json fix = json::parse(tool::contents(path("report/fix.json"))),
               check = json::parse(tool::contents(path("check.json")));
    std::map<std::string, json> reported;
    for (const json& clip : fix["clips"]) reported[clip["clip"]] = clip["events"];
    CHECK(check["clips"].size() == fix["clips"].size());
    for (const json& clip : check["clips"]) {
      for (const json& found : clip["events"]) {
        const bool is_fault = found["class"] == "penetration" || found["class"] == "inside";
        if (!is_fault || found["depth_mm"].get<double>() < kSameMeasure) continue;
        CAPTURE(found);
        const json& events = reported[clip["clip"]];
        CHECK(std::any_of(events.begin(), events.end(), [&](const json& event) {
          return parts_of(event) == parts_of(found) && event["outcome"] != "cleared" &&
                 event["from"].get<double>() - 8 <= found["to"].get<double>() &&
                 found["from"].get<double>() <= event["to"].get<double>() + 8;
        }));
      }
    }
  }
}
