// SPDX-License-Identifier: GPL-3.0-or-later
// `fix --decisions`, and how much `fix` says that it moves: an arm that swings into a wall twice.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "baker/import/import.h"
#include "baker/motion/clip.h"
#include "temporary_folder.h"
#include "tool.h"
#include "wall_and_arm.h"

using namespace spherechain::baker;
using nlohmann::json;

namespace {

constexpr int kSwingFrames = 150;

// -10 degrees, which is free of the wall, and into it around each of these frames.
std::vector<double> swings(const std::vector<int>& frames) {
  std::vector<double> out(kSwingFrames, -10);
  for (int f = 0; f < kSwingFrames; ++f) {
    for (const int at : frames)
      out[static_cast<std::size_t>(f)] = std::max(out[static_cast<std::size_t>(f)], 6.0 - 4 * std::abs(f - at));
  }
  return out;
}

struct Fixer {
  TemporaryFolder folder;
  std::filesystem::path file, out = folder.path / "out.glb";
  json report;

  explicit Fixer(const std::vector<double>& degrees) : file(folder.write("arm.glb", wall_and_arm(degrees))) {}

  tool::Run run(const std::string& options = {}) {
    const std::string words =
        "fix " + file.string() + " -o " + out.string() + " --report " + (folder.path / "report").string();
    tool::Run run = tool::run(words + " " + options);
    if (run.code == 0 || run.code == 5)
      report = json::parse(tool::contents(folder.path / "report/fix.json"))["clips"][0];
    return run;
  }
  tool::Run decide(const json& decisions) {
    return run("--decisions " +
               folder.write("decisions.json", json{{"spherechain_decisions", decisions}}.dump()).string());
  }

  json decision(std::size_t event, const char* what) const {
    const json& its = report["events"][event];
    return {{"clip", "swing"}, {"parts", its["parts"]}, {"from", its["from"]}, {"to", its["to"]}, {"decision", what}};
  }

  // The middle of the paddle in each frame, in mm.
  static std::vector<Vec3> paddle(const std::filesystem::path& glb) {
    const Character character = import_character(glb);
    std::vector<Vec3> out;
    for (int f = 0; f < kSwingFrames; ++f) {
      out.emplace_back(1000 * (world_at(character.rig, character.rig.clips[0], f / 30.0)[2] * Vec3(0, -0.4, 0)));
    }
    return out;
  }
};

}  // namespace

TEST_CASE("fix: it says how far the pose moves, as the two files have it") {
  Fixer fixer(swings({40, 110}));
  CHECK(fixer.run().code == 0);
  const std::vector<Vec3> before = Fixer::paddle(fixer.file), after = Fixer::paddle(fixer.out);
  double most = 0, step = 0;
  for (std::size_t f = 0; f < kSwingFrames; ++f) {
    most = std::max(most, (after[f] - before[f]).norm());
    if (f > 0) step = std::max(step, (after[f] - after[f - 1]).norm() - (before[f] - before[f - 1]).norm());
  }
  CHECK(most > 20);
  const json& acting = fixer.report["acting"];
  CHECK(acting["moves_mm"]["paddle"].get<double>() == doctest::Approx(most).epsilon(0.001));
  CHECK(acting["turns_degrees"]["paddle"].get<double>() <= 25);
  REQUIRE(fixer.report["events"].size() == 2);
  for (const json& event : fixer.report["events"]) {
    CHECK(event["acting"]["moves_mm"]["paddle"].get<double>() == doctest::Approx(most).epsilon(0.02));
    CHECK(event["acting"]["verdict"] == "small");
  }
  // The height of this character is that of its wall and block: 2 m or little more.
  CHECK(acting["step_percent"].get<double>() == doctest::Approx(step / 20).epsilon(0.2));
}

TEST_CASE("fix: docs/json.md names every key of fix.json") {
  Fixer fixer(swings({40}));
  CHECK(fixer.run().code == 0);
  const std::string page = tool::contents(SPHERECHAIN_SAMPLES "/../docs/json.md");
  const json &clip = fixer.report, &event = clip["events"][0], &acting = event["acting"];
  for (const json& object : {clip, event, acting}) {
    for (const auto& [key, value] : object.items()) {
      CHECK_MESSAGE(page.find("`" + key + "`") != std::string::npos, key);
    }
  }
}

TEST_CASE("fix: what is refused stays as animated, and nothing else changes") {
  Fixer fixer(swings({40, 110}));
  CHECK(fixer.run().code == 0);
  REQUIRE(fixer.report["events"].size() == 2);
  const json first = fixer.decision(0, "refuse"), second = fixer.decision(1, "refuse");
  const std::vector<Vec3> animated = Fixer::paddle(fixer.file), cured = Fixer::paddle(fixer.out);

  const tool::Run one = fixer.decide(json::array({first}));
  CHECK_MESSAGE(one.code == 0, one.out);
  CHECK(one.error == "");
  const std::vector<Vec3> decided = Fixer::paddle(fixer.out);
  for (std::size_t f = 0; f < kSwingFrames; ++f) CHECK(decided[f] == (f < 75 ? animated : cured)[f]);
  CHECK(fixer.report["events"][0]["outcome"] == "refused");
  CHECK(fixer.report["events"][0]["depth_mm_after"] == fixer.report["events"][0]["depth_mm_before"]);
  CHECK(fixer.report["events"][1]["outcome"] == "cleared");
  CHECK(fixer.report["events"][0]["held_by"].empty());

  CHECK(fixer.decide(json::array({first, second})).code == 0);
  CHECK(tool::contents(fixer.out) == tool::contents(fixer.file));
}

TEST_CASE("fix: an accepted event keeps its pose beside a refused one, and the joint fades between them") {
  Fixer fixer(swings({60, 65}));
  fixer.run();
  REQUIRE(fixer.report["events"].size() == 2);
  const std::vector<Vec3> animated = Fixer::paddle(fixer.file), cured = Fixer::paddle(fixer.out);
  const int from = fixer.report["events"][1]["from"], to = fixer.report["events"][1]["to"];
  const tool::Run run = fixer.decide(json::array({fixer.decision(0, "refuse"), fixer.decision(1, "accept")}));
  CHECK(run.code == 0);
  const std::vector<Vec3> decided = Fixer::paddle(fixer.out);
  for (int f = from; f <= to; ++f)
    CHECK((decided[static_cast<std::size_t>(f)] - cured[static_cast<std::size_t>(f)]).norm() < 1e-3);
  CHECK((decided[57] - animated[57]).norm() < 0.5 * (cured[57] - animated[57]).norm());
  CHECK(fixer.report["events"][0]["held_by"] == json::array({1}));
  CHECK(run.out.find("refused, small: paddle") != std::string::npos);
  CHECK(run.out.find("; stays turned where it meets ") != std::string::npos);
  for (std::size_t f = 1; f < kSwingFrames; ++f) {
    CHECK((decided[f] - animated[f] - decided[f - 1] + animated[f - 1]).norm() < 25);
  }
}

TEST_CASE("fix: a decision about no event is named, and a file that holds no decisions is refused") {
  Fixer fixer(swings({40}));
  json elsewhere{{"clip", "swing"}, {"parts", {"wall", "paddle"}}, {"from", 7}, {"to", 9}, {"decision", "refuse"}};
  const tool::Run run = fixer.decide(json::array({elsewhere}));
  CHECK(run.code == 0);
  CHECK(run.error.find("decisions.json: is about no event of this run: 'swing': wall, paddle, frames 7-9") !=
        std::string::npos);
  std::filesystem::remove(fixer.out);
  const auto check = [&](const std::string& text, const std::vector<std::string>& parts) {
    tool::check_error(fixer.run("--decisions " + fixer.folder.write("decisions.json", text).string()), 3, parts);
    CHECK(!std::filesystem::exists(fixer.out));
  };
  check("{", {"decisions.json", "line 1 is not JSON"});
  check("glTF" + std::string(5000, '['), {"decisions.json", "line 1 is not JSON"});
  check("[]", {"decisions.json", "spherechain_decisions"});
  elsewhere["from"] = 1.5;
  check(json{{"spherechain_decisions", json::array({elsewhere})}}.dump(), {"entry 1", "'from'", "a frame's number"});
  elsewhere["from"] = 7;
  json other = elsewhere;
  other["decision"] = "accept";
  check(json{{"spherechain_decisions", json::array({elsewhere, other})}}.dump(), {"accepts and refuses one event"});
  other["decision"] = "perhaps";
  check(json{{"spherechain_decisions", json::array({other})}}.dump(), {"entry 1", "'decision'", "accept or refuse"});
  tool::check_error(fixer.run("--decisions " + (fixer.folder.path / "none.json").string()), 3, {"none.json"});
}
