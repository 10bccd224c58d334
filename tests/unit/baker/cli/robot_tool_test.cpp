// SPDX-License-Identifier: GPL-3.0-or-later
// The tool on a robot: baked, played, checked, filtered.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "small_robot.h"
#include "tool.h"

using nlohmann::json;

namespace {

// The elbow folds in 61 frames; from frame 55 on the upper arm is in the base.
std::string fold() {
  std::string out = "time,turn,elbow\n";
  for (int i = 0; i <= 60; ++i)
    out += std::to_string(i / 30.0) + "," + std::to_string(i * 0.01) + "," + std::to_string(i * 0.05) + "\n";
  return out;
}

std::string baked(const small_robot::Files& files) {
  const std::string asset = (files.folder / "arm.sphc").string();
  const tool::Run bake = tool::run("bake " + files.urdf().string() + " -o " + asset);
  REQUIRE(bake.code == 0);
  CHECK(bake.out.find("tall; forward is x") != std::string::npos);
  return asset + " --source " + files.urdf().string();
}

}  // namespace

TEST_CASE("play names a robot's links, and counts the alarms of its own colliders") {
  const small_robot::Files files;
  const std::string motion = files.write("fold.csv", fold()).string(), out = (files.folder / "play.json").string();
  const tool::Run play = tool::run("play " + baked(files) + " --motion " + motion + " --json " + out);
  REQUIRE(play.code == 0);
  CHECK(play.out.find("61 frames at 30 fps") != std::string::npos);
  const json result = json::parse(tool::contents(out));
  REQUIRE(result["clips"][0]["contacts"].size() == 1);
  CHECK(result["clips"][0]["contacts"][0]["a"] == "base");
  CHECK(result["clips"][0]["contacts"][0]["b"] == "upper");
  // The base's collider is wider than the base: it alarms first.
  const json& pair = result["colliders"]["pairs"][0];
  CHECK(pair["links"] == json{"base", "upper"});
  const int alarms = pair["alarm_frames"], wrong = pair["false_alarm_frames"], real = alarms - wrong;
  CHECK(real == result["clips"][0]["contact_frames"]);  // CGAL's bodies, and the runtime's triangles
  CHECK(wrong > 0);
  CHECK(pair["missed_frames"] == 0);
  CHECK(result["colliders"]["alarm_frames"] == alarms);
}

TEST_CASE("filter writes a robot's SRDF, fixed links and neighbours included") {
  const small_robot::Files files;
  const std::string srdf = (files.folder / "arm.srdf").string();
  REQUIRE(tool::run("filter " + baked(files) + " --poses 400 -o " + srdf).code == 0);
  const std::string text = tool::contents(srdf);
  CHECK(text.find("<robot name=\"arm\">") != std::string::npos);
  CHECK(text.find("link1=\"base\" link2=\"lower\" reason=\"Adjacent\"") != std::string::npos);
  CHECK(text.find("link1=\"upper\" link2=\"tool\" reason=\"Adjacent\"") != std::string::npos);
  CHECK(text.find("link1=\"base\" link2=\"upper\"") == std::string::npos);  // meets within the elbow's limits
}

TEST_CASE("check takes a folder with a robot and its meshes for one character") {
  const small_robot::Files files;
  files.urdf();
  files.write("fold.csv", fold());
  const std::string report = (files.temporary.path / "report").string();
  const tool::Run check = tool::run("check " + files.folder.string() + " --motion " +
                                    (files.folder / "fold.csv").string() + " -o " + report);
  CHECK(check.code == 6);
  CHECK(check.out.find("arm.urdf") != std::string::npos);
  CHECK((check.out + check.error).find("link.stl") == std::string::npos);
}

TEST_CASE("fix says that it takes no robots") {
  const small_robot::Files files;
  tool::check_error(tool::run("fix " + files.urdf().string() + " -o " + (files.folder / "a.glb").string()), 3,
                    {"arm.urdf", "is a robot"});
}
