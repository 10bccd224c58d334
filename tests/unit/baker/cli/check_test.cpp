// SPDX-License-Identifier: GPL-3.0-or-later
// `spherechain check` on a library whose faults are known.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "baker/check/file_hash.h"
#include "baker/check/library.h"
#include "baker/check/run.h"
#include "baker/check/store.h"
#include "baker/check/verdict.h"
#include "baker/mesh/error.h"
#include "baker/os/child_process.h"
#include "planted_library.h"
#include "tool.h"

namespace {

namespace baker = spherechain::baker;
namespace fs = std::filesystem;
using nlohmann::json;

const std::vector<PlantedClip> kClips{
    {"clean", {-100, -50, -100, -200}},
    {"dip", {-50, -50, 60, 120, 200, 80, -50, -50}},
    {"bridged", {100, -50, -50, -50, 150, -50}},
    {"twice", {100, -50, -50, -50, -50, 150, -50}},
    {"still", {90}},
    {"loop", {150, 90, -50, -50, -50, -50, -50, -50, 80, 150}},
};

// From above the wall to below it, in its face within a frame; and from one side of it to the other, not on the way.
const std::vector<PlantedClip> kThrough{{"through", {150, 150, 150, 150}, true, {1500, 1400, -1400, -1500}},
                                        {"jumps", {-50, 1650}}};
// At 15 frames a second it is above the wall in both, and in its face on the way.
const std::vector<PlantedClip> kDetour{{"detour", {150, 150, 150}, true, {1500, 0, 1500}}};

// All tests of one content share this cache, so that the bake is made once.
const std::string& shared_cache() {
  static const TemporaryFolder folder;
  static const std::string option = " --cache " + folder.path.string();
  return option;
}

struct PlantedLibrary {
  TemporaryFolder folder;
  fs::path file;
  explicit PlantedLibrary(const std::vector<PlantedClip>& clips = kClips)
      : file(folder.write("hero.glb", planted_character(clips))) {}

  std::string report() const { return (folder.path / "report").string(); }
  std::string path(const char* name) const { return (folder.path / name).string(); }
  tool::Run check(const std::string& more) const {
    return tool::run(fmt::format("check {} -o {} {} {}", file.string(), report(), shared_cache(), more));
  }
  json read(const char* name) const { return json::parse(tool::contents(folder.path / name)); }
};

// "from-to@deepest:depth state", one after another.
std::string events_in(const json& report, const std::string& clip) {
  std::string out;
  for (const json& one : report["clips"]) {
    if (one["clip"] != clip) continue;
    for (const json& event : one["events"]) {
      CHECK(event["parts"] == json{"ball", "wall"});
      out +=
          fmt::format("{}{}-{}@{}:{:.0f} {}", out.empty() ? "" : ", ", event["from"].get<int>(), event["to"].get<int>(),
                      event["deepest"].get<int>(), event["depth_mm"].get<double>(), event["state"].get<std::string>());
    }
  }
  return out;
}

// docs/json.md names every key.
void check_documented(const json& value) {
  static const std::string page = tool::contents(SPHERECHAIN_SAMPLES "/../docs/json.md");
  if (!value.is_structured()) return;
  for (const auto& [key, inner] : value.items()) {
    if (value.is_object()) CHECK_MESSAGE(page.find("`" + key + "`") != std::string::npos, key);
    check_documented(inner);
  }
}

// One space where there are several.
std::string squeezed(std::string text) {
  text.erase(std::unique(text.begin(), text.end(), [](char a, char b) { return a == ' ' && b == ' '; }), text.end());
  return text;
}

}  // namespace

TEST_CASE("check reports planted faults: parts, frames and depth") {
  const PlantedLibrary library;
  const tool::Run run = library.check("--json " + library.path("all.json"));
  CHECK_MESSAGE(run.code == 6, run.error);
  const std::string text = squeezed(run.out);
  CHECK(std::regex_search(text,
                          std::regex(R"(hero\.glb dip frames 2-5 ball in wall 200 mm, [0-9.]+ % \(worst at 4\)\n)")));
  CHECK(std::regex_search(text, std::regex(R"(hero\.glb still frame 0 ball in wall 90 mm, [0-9.]+ %\n)")));
  CHECK(squeezed(run.out).find("hero.glb loop frames 8-1 (over the loop) ball") != std::string::npos);
  const json report = library.read("all.json");
  CHECK(events_in(report, "clean").empty());
  CHECK(events_in(report, "dip") == "2-5@4:200 new");
  CHECK(events_in(report, "bridged") == "0-4@4:150 new");
  CHECK(events_in(report, "twice") == "0-0@0:100 new, 5-5@5:150 new");
  CHECK(events_in(report, "still") == "0-0@0:90 new");
  CHECK(events_in(report, "loop") == "8-1@0:150 new");
  const json& event = report["clips"][1]["events"][0];
  CHECK(event["class"] == "penetration");
  CHECK(event["rule"].is_null());
  CHECK(event["direction"][0] > 0.99);  // moves the ball, the second
  CHECK(event["volume_ml"].is_number());
  CHECK(event["camera"]["back"].size() == 3);
  const json& summary = report["summary"];
  CHECK(summary["characters"] == 1);
  CHECK(summary["clips"] == 6);
  CHECK(summary["frames"] == 36);
  CHECK(summary["events"] == 6);
  CHECK(summary["penetrations"] == 6);
  CHECK(summary["new"] == 6);
  CHECK(summary["seconds"] == doctest::Approx(36 / 30.0));
  for (const json& clip : report["clips"]) CHECK(clip["fps"] == 30);
  CHECK(fs::exists(library.folder.path / "report/library.js"));
}

TEST_CASE("check fails by its rules and its baseline alone" * doctest::test_suite("long runs")) {
  PlantedLibrary library;
  const std::string baseline = " --baseline " + library.path("baseline.json"),
                    json_file = " --json " + library.path("all.json");
  CHECK(library.check(" --fail-on none").code == 0);
  CHECK(library.check(" --max-depth 500").code == 0);
  CHECK(library.check(" --max-depth 199").code == 6);
  library.folder.write(
      "rules.json",
      R"({"allow": [{"parts": ["ball", "wall"], "depth_mm": 160}], "severity": {"penetration": "warning"}})");
  CHECK(library.check(json_file + " --config " + library.path("rules.json")).code == 0);
  CHECK(events_in(library.read("all.json"), "dip") == "2-5@4:200 new");
  CHECK(library.read("all.json")["clips"][1]["events"][0]["rule"].is_null());
  CHECK(library.read("all.json")["clips"][2]["events"][0]["rule"] == "ball and wall: 160 mm are allowed");
  library.folder.write("rules.json", R"({"leave_out": ["ball"]})");
  CHECK(library.check(json_file + " --config " + library.path("rules.json")).code == 0);
  CHECK(events_in(library.read("all.json"), "dip").empty());
  library.folder.write("rules.json", R"({"allow": [{"parts": ["*", "bal"], "depth_mm": 500}]})");
  CHECK(library.check(" --config " + library.path("rules.json")).out.find("a rule names 'bal'") != std::string::npos);
  tool::check_error(library.check("--config " + library.folder.write("rules.json", "{\"alow\": []}").string()), 3,
                    {"'alow' is unknown"});

  tool::check_error(library.check(baseline), 3, {"baseline.json"});
  CHECK(library.check(baseline + " --accept").code == 0);
  CHECK(library.check(baseline).code == 0);

  // An edit: one fault is gone, one is later and as deep, one deeper, one is new.
  std::vector<PlantedClip> edited = kClips;
  edited[0].depths_mm[2] = 60;
  edited[1].depths_mm = {-50, -50, -50, -50, 60, 120, 200, -50};
  edited[2].depths_mm[4] = 170;
  edited[4].depths_mm = {-50};
  library.folder.write("hero.glb", planted_character(edited));
  const tool::Run run = library.check(baseline + json_file + " --fail-on new --junit " + library.path("junit.xml") +
                                      " --sarif " + library.path("check.sarif"));
  CHECK(run.code == 6);
  CHECK(run.out.find("worse than 150 mm") != std::string::npos);
  const json report = library.read("all.json");
  check_documented(report);
  CHECK(events_in(report, "clean") == "2-2@2:60 new");
  CHECK(events_in(report, "dip") == "4-6@6:200 accepted");
  CHECK(events_in(report, "bridged") == "0-4@4:170 new");
  CHECK(events_in(report, "still") == "0-0@0:90 resolved");
  CHECK(run.out.find("[accepted]") == std::string::npos);
  CHECK(report["summary"]["new"] == 2);
  CHECK(report["summary"]["resolved"] == 1);
  const std::string junit = tool::contents(library.path("junit.xml"));
  CHECK(junit.find("tests=\"6\" failures=\"2\" errors=\"0\"") != std::string::npos);
  CHECK(junit.find("170 mm deep at frame 4, worse than 150 mm") != std::string::npos);
  const json sarif = library.read("check.sarif")["runs"][0]["results"];
  CHECK(sarif[0]["baselineState"] == "new");
  CHECK(sarif[0]["level"] == "error");
}

TEST_CASE("--accept drops an entry of a baseline only if its fault was looked for and is gone, and keeps its keys" *
          doctest::test_suite("long runs")) {
  using nlohmann::ordered_json;
  PlantedLibrary library;
  const std::string file = library.path("baseline.json"), accept = " --accept --baseline " + file;
  REQUIRE(library.check(accept).code == 0);
  ordered_json baseline = {{"about", {{"reviewed by", "Ann"}}}};
  baseline.update(ordered_json::parse(tool::contents(file)));
  ordered_json& entries = baseline["spherechain_baseline"];
  REQUIRE(entries.size() == 6);
  for (std::size_t i = 0; i < entries.size(); ++i) entries[i]["ticket"] = i;
  library.folder.write("baseline.json", baseline.dump());
  const auto rules = [&](const char* name, const char* text) {
    return " --config " + library.folder.write(name, text).string();
  };
  for (const std::string& more : {std::string(" --max-depth 500"), rules("a.json", R"({"leave_out": ["ball"]})"),
                                  rules("b.json", R"({"allow": [{"parts": ["ball", "*"], "depth_mm": 160}]})"),
                                  rules("c.json", R"({"severity": {"penetration": "ignore"}})"),
                                  std::string(" --fps 2"), std::string(" --continuous"), std::string()}) {
    CAPTURE(more);
    const tool::Run run = library.check(accept + more);
    CHECK(run.code == 0);
    CHECK(run.out.find("resolved") == std::string::npos);
    CHECK(ordered_json::parse(tool::contents(file)) == baseline);
  }
  // One fault is new, one is deeper, one is gone.
  std::vector<PlantedClip> edited = kClips;
  edited[0].depths_mm[2] = 60;
  edited[2].depths_mm[4] = 170;
  edited[4].depths_mm = {-50};
  library.folder.write("hero.glb", planted_character(edited));
  CHECK(library.check(accept).out.find("1 resolved") == std::string::npos);
  const ordered_json after = ordered_json::parse(tool::contents(file))["spherechain_baseline"];
  REQUIRE(after.size() == 6);
  CHECK(after[0] == entries[0]);
  CHECK(after[1]["ticket"] == 1);
  CHECK(after[1]["depth_mm"].get<double>() == doctest::Approx(170).epsilon(0.01));
  CHECK(after[2] == entries[2]);
  CHECK(after[3] == entries[3]);
  CHECK(after[4] == entries[5]);
  CHECK(after[5]["clip"] == "clean");
}

TEST_CASE("what is wrong with a baseline, rules or a manifest is reported by file, entry and key") {
  const PlantedLibrary library({kClips[1]});
  const std::string file = library.path("baseline.json");
  REQUIRE(library.check(" --accept --baseline " + file).code == 0);
  const json good = library.read("baseline.json");
  const auto refuses = [&](const std::string& option, const std::string& text, const std::string& what) {
    const std::string wrong = library.folder.write("wrong.json", text).string();
    tool::check_error(library.check(option + " " + wrong), 3, {"wrong.json: " + what});
  };
  refuses("--baseline", "{\n \"spherechain_baseline\": [\n  {]\n}", "is no baseline: line 3 is not JSON");
  refuses("--baseline", "[1]", "is no baseline: it has no list 'spherechain_baseline'");
  refuses("--baseline", R"({"spherechain_baseline": [7]})", "'spherechain_baseline', entry 1: is not an object");
  refuses("--baseline", std::string(5000, '[') + std::string(5000, ']'), "is no baseline: it is nested too deeply");
  for (const auto& [key, value] : std::vector<std::pair<const char*, json>>{{"character", 3},
                                                                            {"clip", nullptr},
                                                                            {"parts", {"ball"}},
                                                                            {"class", "penetrates"},
                                                                            {"from_seconds", -1},
                                                                            {"to_seconds", "2"},
                                                                            {"depth_mm", {}},
                                                                            {"state", "acepted"}}) {
    json wrong = good;
    wrong["spherechain_baseline"].push_back(good["spherechain_baseline"][0]);
    wrong["spherechain_baseline"][1][key] = value;
    const std::string start = fmt::format("'spherechain_baseline', entry 2: '{}' ", key);
    refuses("--baseline", wrong.dump(), start + "is not ");
    wrong["spherechain_baseline"][1].erase(key);
    refuses("--baseline", wrong.dump(), start + "is missing");
  }
  refuses("--config", "{\"allow\": [],\n}", "is not a JSON object (docs/checking-a-library.md has one): line 2");
  refuses("--config", R"({"allow": [{"parts": ["a", "b"], "depth_mm": 1}, {"parts": ["a"], "depth_mm": 1}]})",
          "'allow', entry 2: 'parts' is not a list of two");
  refuses("--config", R"({"allow": [{"parts": ["a", 2], "depth_mm": 1}]})",
          "'allow', entry 1: 'parts' is not the name");
  refuses("--config", R"({"allow": [{"parts": ["a", "b"], "depth_mm": "1"}]})",
          "'allow', entry 1: 'depth_mm' is not a");
  refuses("--config", R"({"allow": [{"parts": ["a", "b"], "depth": 1}]})", "'allow', entry 1: 'depth' is unknown");
  refuses("--config", R"({"leave_out": ["a", null]})", "'leave_out', entry 2 is not the name");
  refuses("--config", R"({"severity": {"deep_fold": "eror"}})", "'severity': 'deep_fold' is not error");
  refuses("--config", R"({"bake": {"spheres": "many"}})", "'bake': setting 'spheres' is not");
  const auto manifest = [&](const char* text, const std::string& what) {
    const std::string wrong = library.folder.write("library.json", text).string();
    tool::check_error(tool::run("check " + wrong + " -o " + library.report()), 3, {"library.json: " + what});
  };
  manifest("{\n\n", "is not a manifest (an object with a list 'characters'): line ");
  manifest(R"({"characters": ["hero.glb", {"file": 3}]})", "'characters', entry 2: 'file' is not a path");
  manifest(R"({"characters": [{"file": "hero.glb", "rig": 1}]})", "'characters', entry 1: 'rig' is unknown");
  manifest(R"({"characters": [{"file": "hero.glb", "config": {"leave_out": 1}}]})",
           "'characters', entry 1: 'config': 'leave_out' is not a list");
}

TEST_CASE("check and play say which joint a scale of 0 hides, and in how many frames" *
          doctest::test_suite("long runs")) {
  const std::vector<PlantedClip> hidden{{"gone", {200, 200, -50, -50, -50}, false, {}, {0, 0, 1, 1, 1}},
                                        {"small", {-50, -50}, false, {}, {1, 0.01}}};
  const PlantedLibrary library(hidden);
  const std::string asset = library.path("hero.sphc"), note = "gone: 'ball' has a scale of 0 in 2 of 5 frames";
  const tool::Run check = library.check("--fail-on none");
  CHECK(check.out.find("note: hero.glb " + note) != std::string::npos);
  CHECK(check.out.find("small") == std::string::npos);
  REQUIRE(tool::run("bake " + library.file.string() + " -o " + asset).code == 0);
  const tool::Run play = tool::run("play " + asset + " --source " + library.file.string());
  CHECK(play.error.find("spherechain: note: " + library.file.string() + ": " + note) != std::string::npos);
  CHECK(play.error.find("small") == std::string::npos);
}

TEST_CASE("check and play say which clip is over before its second frame" * doctest::test_suite("long runs")) {
  const PlantedLibrary library(
      {{"brief", {-50, 90, 90}, false, {}, {}, 1e-3F}, {"pose", {-50, -50}, false, {}, {}, 1e-3F}});
  const std::string asset = library.path("hero.sphc"), note = "brief: lasts 6.7e-05 s, so one of its 3 keys is looked";
  CHECK(library.check("").out.find("note: hero.glb " + note) != std::string::npos);
  REQUIRE(tool::run("bake " + library.file.string() + " -o " + asset).code == 0);
  const tool::Run play = tool::run("play " + asset + " --source " + library.file.string());
  CHECK(play.error.find(library.file.string() + ": " + note) != std::string::npos);
  CHECK(play.error.find("pose") == std::string::npos);
}

TEST_CASE("check, play and fix name two parts in one order, and play the way of the first" *
          doctest::test_suite("long runs")) {
  const PlantedLibrary library({kClips[1]});
  const std::string asset = library.path("hero.sphc");
  CHECK(library.check("").out.find("ball in wall") != std::string::npos);
  REQUIRE(tool::run("bake " + library.file.string() + " -o " + asset).code == 0);
  const std::string play = squeezed(tool::run("play " + asset + " --source " + library.file.string()).out);
  CHECK(play.find(" ball wall frames 2-5 200 mm deep at 4, out along (1.00, ") != std::string::npos);
  const tool::Run fix = tool::run("fix " + library.file.string() + " -o " + library.path("mended.glb"));
  CHECK_MESSAGE(squeezed(fix.out).find(" ball, wall 2-5 ") != std::string::npos, fix.out);
}

TEST_CASE("pictures and heat maps show what the rules leave") {
  const PlantedLibrary library;
  const auto page = [&](const std::string& more) {
    library.check(more);
    const std::string text = tool::contents(library.folder.path / "report/library.js");
    const json row = json::parse(text.substr(text.find('{'), text.rfind('}') + 1 - text.find('{')))["rows"][1];
    CHECK(fs::exists(library.folder.path / "report" / row["picture"].get<std::string>()));
    const std::string heat =
        tool::contents(library.folder.path / "report" / (row["body"].get<std::string>() + "_heat.js"));
    return std::pair(row["picture"].get<std::string>().find("_1.png") != std::string::npos,
                     heat.find("\"triangles\":\"\"") == std::string::npos);
  };
  CHECK(page("") == std::pair(true, true));
  CHECK(page("--max-depth 500") == std::pair(false, false));
  CHECK(page("--max-depth 199") == std::pair(true, true));
  library.folder.write("rules.json", R"({"leave_out": ["ball"]})");
  CHECK(page("--config " + library.path("rules.json")) == std::pair(false, false));
}

TEST_CASE("check deletes and replaces in its folder only what it wrote there itself") {
  const PlantedLibrary library;
  const fs::path report = library.report(), folder = library.folder.path;
  const auto refused = [&](const std::string& to, const std::string& part) {
    tool::check_error(tool::run(fmt::format("check {} -o {} {}", library.file.string(), to, shared_cache())), 3,
                      {part});
  };
  // A stranger's pages, and a folder of sources, are no report.
  for (const char* name : {"web", "web/data", "proj", "proj/data"}) fs::create_directory(folder / name);
  library.folder.write("web/library.js", "export default 1");
  library.folder.write("web/data/table.csv", "1,2");
  refused((folder / "web").string(), "holds other files than a check report");
  fs::copy(library.file, folder / "proj/data/hero.glb");
  refused((folder / "proj").string(), "holds other files than a check report");
  CHECK(tool::files_in(folder / "web") == 2);
  CHECK(fs::exists(folder / "web/data/table.csv"));
  CHECK(fs::exists(folder / "proj/data/hero.glb"));

  // A report is filled again: what somebody added stays, what was damaged is written again, the rest is exchanged.
  const std::string files = fmt::format("--json {0}/a.json --junit {0}/a.xml --sarif {0}/a.sarif", folder.string());
  REQUIRE(library.check(files).code == 6);
  fs::copy(report, folder / "first", fs::copy_options::recursive);
  library.folder.write("report/notes.txt", "mine");
  library.folder.write("report/data/notes.js", "mine");
  for (const auto& entry : fs::recursive_directory_iterator(report / "data")) {
    if (entry.path().filename() == "notes.js" || !entry.is_regular_file()) continue;
    fs::resize_file(entry.path(), 9);
  }
  REQUIRE(library.check(files).code == 6);
  CHECK(tool::contents(report / "notes.txt") == "mine");
  CHECK(tool::contents(report / "data/notes.js") == "mine");
  fs::remove(report / "notes.txt");
  fs::remove(report / "data/notes.js");
  const std::string same = fmt::format("diff -r {} {}", report.string(), (folder / "first").string());
  CHECK(std::system(same.c_str()) == 0);
  const std::size_t entries = tool::files_in(report);

  // Other rules show other pictures: those of before go, and come back.
  REQUIRE(library.check("--max-depth 500").code == 0);
  CHECK(std::system((same + " >/dev/null").c_str()) != 0);
  REQUIRE(library.check("").code == 6);
  CHECK(std::system(same.c_str()) == 0);
  CHECK(tool::files_in(report) == entries);

  // A page that somebody changed is theirs; so are all beside a list that was copied, or names other places.
  const std::string page = tool::contents(report / "library.js") + "// mine\n";
  library.folder.write("report/library.js", page);
  refused(report.string(), "library.js: exists and is not what spherechain wrote into this check report");
  CHECK(tool::contents(report / "library.js") == page);
  const std::string list = tool::contents(report / ".spherechain");
  library.folder.write("web/.spherechain", list);
  refused((folder / "web").string(), "library.js: exists and is not what spherechain wrote");
  fs::remove(folder / "web/library.js");
  const std::string hash = list.substr(list.find("  library.js") - 64, 64);
  library.folder.write("library.js", tool::contents(folder / "first/library.js"));
  library.folder.write("web/.spherechain",
                       list + hash + "  ../library.js\n" + hash + "  " + (folder / "library.js").string() + "\n");
  CHECK(tool::run(fmt::format("check {} -o {}/web {}", library.file.string(), folder.string(), shared_cache())).code ==
        6);
  CHECK(fs::exists(folder / "library.js"));
  CHECK(tool::contents(folder / "web/data/table.csv") == "1,2");
  tool::check_error(library.check("--fix " + library.report()), 2, {"-o and --fix are the same folder"});
}

TEST_CASE("two checks into one report at a time are both right; one that is killed leaves nothing of its own" *
          doctest::test_suite("many bakes")) {
  const PlantedLibrary library;
  const fs::path report = library.report();
  const std::string check = fmt::format("check {} -o {}", library.file.string(), report.string());
  const tool::Run run = tool::run(
      fmt::format("{0} & p=$!; {1} {0} >{2}/other; wait $p", check, SPHERECHAIN_TOOL, library.folder.path.string()));
  CHECK(run.code == 6);
  CHECK(tool::contents(library.folder.path / "other") == run.out);
  const std::size_t entries = tool::files_in(report);
  fs::remove_all(report);
  // Only the tool: its workers follow by themselves.
  for (const char* signal : {"KILL", "TERM"}) {
    tool::run(
        fmt::format("{0} & p=$!; until ls {1}/.spherechain-*.work >/dev/null 2>&1; do sleep .01; done; kill -{2} $p; "
                    "wait $p; n=0; while [ -e {1} ] && [ $n -lt 200 ]; do sleep .05; n=$((n+1)); done",
                    check, report.string(), signal));
    CHECK(!fs::exists(report));
  }
  CHECK(tool::run(check).code == 6);
  CHECK(tool::files_in(report) == entries);
}

TEST_CASE("one bad file stops nothing") {
  const PlantedLibrary library;
  library.folder.write("broken.glb", planted_character(kClips).substr(0, 200));
  library.folder.write("empty.fbx", "");
  const tool::Run run =
      tool::run(fmt::format("check {} -o {} {} --json {} --fail-on none", library.folder.path.string(),
                            library.report(), shared_cache(), library.path("all.json")));
  CHECK_MESSAGE(run.code == 0, run.error);
  const json report = library.read("all.json");
  REQUIRE(report["clips"].size() == 8);
  CHECK(report["summary"]["errors"] == 2);
  CHECK(report["clips"][0]["error"].get<std::string>().find("broken.glb: ") != std::string::npos);
  CHECK(events_in(report, "dip") == "2-5@4:200 new");
  const std::string other = library.folder.write("other.json", "{}").string();
  tool::check_error(library.check("--json " + other), 3, {"other.json: exists and is not JSON that spherechain wrote"});
  tool::check_error(library.check("--json " + library.file.string()), 2, {"LIBRARY and --json are the same file"});
  tool::check_error(library.check("--accept"), 2, {"--accept: needs a baseline"});
  tool::check_error(library.check("--shard 4/3"), 2, {"'4/3' is not I/N"});
  tool::check_error(tool::run("check nowhere.glb -o " + library.report()), 3, {"nowhere.glb: there is no such file"});
  tool::check_error(tool::run("check " + library.file.string() + " -o " + library.folder.path.string()), 3,
                    {"holds other files than a check report"});
}

TEST_CASE("faults that are accepted stay so, whatever bytes a name holds" * doctest::test_suite("long runs")) {
  const PlantedLibrary library;
  const fs::path folder = library.folder.path / "lib";
  fs::create_directory(folder);
  std::ofstream(folder / "caf\xe9.glb") << planted_character({{"dip", {-10, 80, -10}}});
  std::ofstream(folder / "caf\xe8.glb") << planted_character({{"dip", {-10, -10, 80, -10}}});
  const std::string check =
      fmt::format("check {} -o {} {} --json {} --fail-on new --baseline {}", folder.string(), library.report(),
                  shared_cache(), library.path("all.json"), library.path("baseline.json"));
  CHECK(tool::run(check + " --accept").code == 0);
  CHECK(tool::run(check).code == 0);
  const json clips = library.read("all.json")["clips"];
  REQUIRE(clips.size() == 2);
  CHECK(clips[0]["character"] == R"(caf\xe8.glb)");
  CHECK(clips[1]["character"] == R"(caf\xe9.glb)");
  // Two names that are not UTF-8 are not one.
  fs::rename(folder / "caf\xe8.glb", folder / "caf\xe7.glb");
  CHECK(tool::run(check).code == 6);
}

TEST_CASE("a file that changes while it is read is not called broken") {
  const TemporaryFolder folder;
  const fs::path file = folder.write("hero.glb", "whole");
  const std::string hash = baker::hash_of_input(file);
  const auto fail = [] { throw baker::Error(baker::ExitCode::kFile, "is cut short"); };
  CHECK_THROWS_WITH(baker::do_unchanged(file, hash, fail), "is cut short");
  const auto change = [&](const auto& then) {
    return [&] {
      folder.write("hero.glb", "half");
      then();
    };
  };
  CHECK_THROWS_AS(baker::do_unchanged(file, hash, change(fail)), baker::Interrupted);
  CHECK_THROWS_AS(baker::do_unchanged(file, hash, change([] {})), baker::Interrupted);
  fs::remove(file);
  CHECK_THROWS_WITH(baker::do_unchanged(file, hash, fail), (file.string() + ": no such file").c_str());
}

TEST_CASE("results that somebody deletes while check runs are lost, and no character is called broken" *
          doctest::test_suite("long runs")) {
  const PlantedLibrary library({{"dip", {-10, 80, -10}}});
  baker::RunOptions options;
  const auto read = baker::read_library({library.file.string()}, "", baker::default_config()).characters;
  for (const std::string when : {"baking", "checking"}) {
    CAPTURE(when);
    const baker::Store store(library.path("cache"));
    const std::string lost = store.folder().string() + ": results are lost (run the check again)";
    const auto check = [&] {
      const auto clips = baker::check_library(read, options, store, [&](const baker::RunState& state) {
        if (state.doing == when && state.done == state.all) fs::remove_all(store.folder());
      });
      baker::evaluate_clips(clips, {{read[0].name, read[0].file.string(), {}}}, store, {}, false,
                            baker::FailOn::kPenetration);
    };
    CHECK_THROWS_WITH(check(), lost.c_str());
  }
}

TEST_CASE("nothing is computed that is in the cache, whatever killed the run that made it" *
          doctest::test_suite("many bakes")) {
  const PlantedLibrary library;
  const std::string command = fmt::format("check {} -o {} --cache {} --json {}", library.file.string(),
                                          library.report(), library.path("cache"), library.path("all.json"));
  for (int i = 0; i < 12; ++i) {
    tool::run(fmt::format("{} & p=$!; sleep {}; kill -9 $p; wait", command, 0.01 * std::pow(1.6, i)));
  }
  CHECK(tool::run(command).code == 6);
  const std::string first = tool::contents(library.path("all.json"));
  CHECK(events_in(json::parse(first), "dip") == "2-5@4:200 new");
  std::map<fs::path, fs::file_time_type> times;
  for (const auto& entry : fs::recursive_directory_iterator(library.path("cache"))) {
    if (entry.is_regular_file()) times[entry.path()] = entry.last_write_time();
  }
  CHECK(tool::run(command).code == 6);
  CHECK(tool::contents(library.path("all.json")) == first);
  for (const auto& [path, time] : times) CHECK(fs::last_write_time(path) == time);
}

TEST_CASE("a damaged file of the cache is as good as none, and is made again" * doctest::test_suite("many bakes")) {
  const PlantedLibrary library({kClips[1]});
  const auto check = [&](const std::string& more) {
    return tool::run(fmt::format("check {} -o {} --cache {} --jobs 1 {} --json {}", library.file.string(),
                                 library.report(), library.path("cache"), more, library.path("all.json")));
  };
  const auto all_files = [](const fs::path& folder) {
    std::map<fs::path, std::string> out;
    for (const auto& entry : fs::recursive_directory_iterator(folder)) {
      if (entry.is_regular_file()) out[entry.path()] = tool::contents(entry.path());
    }
    return out;
  };
  REQUIRE(check("--fps 10").code == 6);
  const std::string at_ten = tool::contents(library.path("all.json"));
  fs::remove_all(library.path("cache"));
  REQUIRE(check("").code == 6);
  const auto report = all_files(library.report()), cache = all_files(library.path("cache"));
  std::size_t count = 0;
  for (const auto& [file, bytes] : cache) {
    std::string damaged = bytes;
    damaged[bytes.size() * (1 + count++ % 3) / 4] ^= 4;
    std::ofstream(file, std::ios::binary) << damaged;
    fs::remove_all(library.report());
    if (file.extension() == ".sphc") {  // of what is cached, needed for another rate
      CHECK(check("--fps 10").code == 6);
      CHECK(tool::contents(library.path("all.json")) == at_ten);
    }
    CHECK(check("").code == 6);
    CHECK(all_files(library.report()) == report);
    CHECK(tool::contents(file) == bytes);
  }
  CHECK(count == 8);
}

TEST_CASE("a link to nothing and a bad baseline are reported, the baseline before any work") {
  const PlantedLibrary library({kClips[1]});
  fs::create_symlink("nowhere", library.folder.path / "gone.glb");
  const tool::Run run = tool::run(
      fmt::format("check {} -o {} {} --fail-on none", library.folder.path.string(), library.report(), shared_cache()));
  CHECK(run.code == 0);
  CHECK(run.out.find("gone.glb: no such file") != std::string::npos);
  fs::remove_all(library.report());
  library.folder.write("bad.json", "{}");
  tool::check_error(library.check("--baseline " + library.path("bad.json")), 3,
                    {"bad.json: is no baseline: it has no list"});
  CHECK_FALSE(fs::exists(library.report()));
  tool::check_error(library.check("--no-such-option"), 2, {"try spherechain check --help"});
}

TEST_CASE("merged shards are what one machine makes, byte for byte") {
  const PlantedLibrary library;
  library.folder.write("second.glb", planted_character({{"dip", {-10, 80, -10}}}));
  library.folder.write("third.glb", "no character");
  const std::string all =
      fmt::format("check {0}/hero.glb {0}/second.glb {0}/third.glb {1}", library.folder.path.string(), shared_cache());
  CHECK(tool::run(all + " -o " + library.path("whole") + " --json " + library.path("whole.json")).code == 6);
  for (const char* part : {"1/3", "2/3", "3/3"}) {
    CHECK(
        tool::run(fmt::format("{} --shard {} -o {}/shard{}", all, part, library.folder.path.string(), part[0])).code ==
        0);
  }
  const std::string merge = fmt::format("check --merge {0}/shard2 {0}/shard1 ", library.folder.path.string());
  const std::string outputs = "-o " + library.path("merged") + " --json " + library.path("merged.json");
  tool::check_error(tool::run(merge + outputs), 3, {"shard 3 of 3 is missing"});
  CHECK(tool::run(merge + library.path("shard3") + " " + outputs).code == 6);
  CHECK(tool::contents(library.path("merged.json")) == tool::contents(library.path("whole.json")));
  CHECK(std::system(fmt::format("diff -r {0}/whole {0}/merged", library.folder.path.string()).c_str()) == 0);
}

TEST_CASE("check --continuous finds what passes through between two frames, and when") {
  const PlantedLibrary library(kThrough);
  REQUIRE(library.check("--json " + library.path("frames.json")).code == 0);
  CHECK(library.read("frames.json")["summary"]["events"] == 0);
  const tool::Run run = library.check("--continuous --json " + library.path("between.json"));
  CHECK(run.code == 6);
  CHECK(run.out.find("frame 1.") != std::string::npos);
  const json report = library.read("between.json");
  check_documented(report);
  CHECK(report["summary"]["frames"] == 6);
  for (const json& clip : report["clips"]) {
    if (clip["clip"] == "jumps") CHECK(clip["events"].empty());
    if (clip["clip"] != "through") continue;
    REQUIRE(clip["events"].size() == 1);
    const json& event = clip["events"][0];
    CHECK(event["class"] == "penetration");
    CHECK(event["from"] == event["to"]);
    CHECK(event["deepest"].get<double>() > 1);
    CHECK(event["deepest"].get<double>() < 2);
    CHECK(event["depth_mm"].get<double>() == doctest::Approx(150).epsilon(0.05));
  }
}

TEST_CASE("check --continuous follows the clip's keys between two frames" * doctest::test_suite("long runs")) {
  const PlantedLibrary library(kDetour);
  REQUIRE(library.check("--fps 15 --json " + library.path("frames.json")).code == 0);
  const tool::Run run = library.check("--fps 15 --continuous --json " + library.path("between.json"));
  CHECK(run.code == 6);
  const json report = library.read("between.json");
  REQUIRE(report["clips"][0]["events"].size() == 1);
  CHECK(report["clips"][0]["events"][0]["depth_mm"].get<double>() == doctest::Approx(150).epsilon(0.05));
}

TEST_CASE("each penetration that play finds is in a fault of check, also where a touch of the same parts is deeper" *
          doctest::test_suite("many bakes")) {
  const std::string models = "/usr/share/assimp/models/";
  const std::string motion = " --motion " + models + "BVH/Boxing_Toes.bvh --fps 10";
  const TemporaryFolder out;
  const auto path = [&](const char* name) { return " " + (out.path / name).string(); };
  REQUIRE(tool::run("play " + tool::baked_files().asset.string() + " --source " + models + "Collada/human.zae" +
                    motion + " --json" + path("play.json"))
              .code == 0);
  REQUIRE(tool::run("check " + models + "Collada/human.zae" + motion + " -o" + path("report") + " --json" +
                    path("check.json"))
              .code == 6);
  const json faults = json::parse(tool::contents(out.path / "check.json"))["clips"].back()["events"];
  const json frames = json::parse(tool::contents(out.path / "play.json"))["frames"];
  std::size_t count = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (const json& found : frames[i]["penetrations"]) {
      if (found["class"] != "penetration") continue;
      ++count;
      CHECK(std::any_of(faults.begin(), faults.end(), [&](const json& event) {
        const std::set<json> parts(event["parts"].begin(), event["parts"].end());
        return (event["class"] == "penetration" || event["class"] == "inside") && event["from"] <= i &&
               event["to"] >= i && parts == std::set<json>(found["parts"].begin(), found["parts"].end());
      }));
    }
  }
  CHECK(count > 50);
}
