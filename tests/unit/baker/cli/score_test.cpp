// SPDX-License-Identifier: GPL-3.0-or-later
// `spherechain score`: files, contract and errors, on an arm that swings into a wall.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "baker/score/score_clip.h"
#include "temporary_folder.h"
#include "tool.h"
#include "wall_and_arm.h"

using namespace spherechain::baker;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

// The arm is in the wall in 9 of 120 frames.
std::vector<double> swinging_arm() {
  std::vector<double> out(120, -10);
  for (std::size_t f = 56; f <= 64; ++f) out[f] = 12 - 1.2 * std::abs(static_cast<double>(f) - 60);
  return out;
}

struct ScoredArm {
  TemporaryFolder folder;
  fs::path arm, out;
  ScoredArm() : arm(folder.write("arm.glb", wall_and_arm(swinging_arm()))), out(folder.path / "score") {}
  tool::Run score(const std::string& more) const {
    return tool::run("score " + arm.string() + " -o " + out.string() + " " + more);
  }
};

}  // namespace

TEST_CASE("score: JSON, CSV and lists hold one clip, whose faults are those of play") {
  const ScoredArm files;
  const tool::Run run = files.score("--json --keep-below fault_frames=0.05,limmt=101");
  REQUIRE_MESSAGE(run.code == 0, run.error);
  const json found = json::parse(run.out), clip = found["clips"][0];
  CHECK(found == json::parse(tool::contents(files.out / "score.json")));
  CHECK(clip["character"] == "arm.glb");
  CHECK(clip["clip"] == "swing");
  CHECK(clip["frames"] == 120);
  CHECK(clip["fps"] == 30);
  CHECK(found["reference"] == nullptr);
  const json& metrics = clip["metrics"];
  CHECK(metrics.size() == metric_names().size());
  CHECK(metrics["fault_frames"].get<double>() == doctest::Approx(9.0 / 120));
  CHECK(metrics["events_per_minute"].get<double>() == doctest::Approx(60.0 / 4));
  CHECK(metrics["depth_percent_max"].get<double>() >= metrics["depth_percent_p50"].get<double>());
  CHECK(metrics["volume_percent"].get<double>() > 0);
  CHECK(metrics["star_penetration_rate"] == nullptr);  // it has no legs
  CHECK(metrics["joint_shift_percent"] == nullptr);
  const std::string csv = tool::contents(files.out / "score.csv");
  CHECK(csv.starts_with("character,clip,frames,fps,fault_frames,"));
  CHECK(csv.find("\narm.glb,swing,120,30,0.075,") != std::string::npos);
  CHECK(tool::contents(files.out / "keep.txt").empty());
  CHECK(tool::contents(files.out / "drop.txt") == "arm.glb\tswing\n");
  CHECK(files.score("--metrics fault_frames --keep-below fault_frames=0.1,limmt=101 --keep-above limmt=1").code == 0);
  CHECK(tool::contents(files.out / "keep.txt") == "arm.glb\tswing\n");
  CHECK(files.score("--metrics fault_frames --keep-below star_penetration_rate=1").code == 0);
  CHECK(tool::contents(files.out / "unmeasured.txt") == "arm.glb\tswing\n");
  CHECK(tool::contents(files.out / "drop.txt").empty());
  // The names of all metrics are explained.
  const std::string page = tool::contents(fs::path(SPHERECHAIN_SAMPLES) / "../docs/cli/score.md");
  for (const std::string& name : metric_names()) CHECK_MESSAGE(page.find("`" + name + "`") != std::string::npos, name);
}

TEST_CASE("score: clips are compared with a reference, and only what is asked for is measured") {
  const ScoredArm files;
  const fs::path take = files.folder.write("take.bvh", recording_of_arm(std::vector<double>(120, -10)));
  const tool::Run run = files.score("--json --metrics fault_frames,joint_shift_percent --reference " + take.string());
  REQUIRE_MESSAGE(run.code == 0, run.error);
  const json found = json::parse(run.out);
  CHECK(found["reference"] == take.string());
  CHECK(found["clips"][0]["metrics"].size() == 2);
  CHECK(found["clips"][0]["metrics"]["fault_frames"].get<double>() == doctest::Approx(9.0 / 120));
  const json same = json::parse(files.score("--json --metrics joint_shift_percent --reference swing").out);
  CHECK(same["clips"][0]["metrics"]["joint_shift_percent"] == 0);
  // A character is compared clip by clip, by their names; another number of frames is another motion.
  CHECK(tool::run("fix " + files.arm.string() + " -o " + (files.folder.path / "mended.glb").string()).code == 0);
  const json mended = json::parse(tool::run("score " + (files.folder.path / "mended.glb").string() + " -o " +
                                            files.out.string() + " --json --reference " + files.arm.string())
                                      .out)["clips"][0]["metrics"];
  CHECK(mended["fault_frames"] == 0);
  CHECK(mended["joint_shift_percent"].get<double>() > 0);
  const fs::path half = files.folder.write("half.bvh", recording_of_arm(std::vector<double>(60, -10)));
  CHECK(json::parse(files.score("--json --metrics joint_shift_percent --reference " + half.string())
                        .out)["clips"][0]["metrics"]["joint_shift_percent"] == nullptr);
  CHECK(found["clips"][0]["metrics"]["joint_shift_percent"] >= 0);
}

TEST_CASE("score: what is wrong is named, and the other characters are scored") {
  const ScoredArm files;
  tool::check_error(files.score("--metrics depth"), 2, {"no metric 'depth'", "fault_frames"});
  tool::check_error(files.score("--keep-below fault_frames"), 2, {"--keep-below", "fault_frames=0.05"});
  CHECK(!fs::exists(files.out / "score.json"));
  const fs::path broken = files.folder.write("broken.glb", "glTF, but no more");
  const tool::Run run = files.score("--metrics fault_frames " + broken.string());
  CHECK(run.code == 3);
  CHECK(run.out.find("not scored: " + broken.string()) != std::string::npos);
  const json found = json::parse(tool::contents(files.out / "score.json"));
  CHECK(found["clips"].size() == 1);
  CHECK(found["failed"][0]["character"] == "broken.glb");
  tool::check_error(files.score("--clip walk"), 3, {"no clip 'walk'"});
  tool::check_error(files.score("--reference nothing.bvh"), 3, {"nothing.bvh", "no file"});
  tool::check_error(files.score("--keep-below fault_frames=10"), 2, {"fault_frames is a share"});
  CHECK(json::parse(tool::contents(files.out / "score.json")) == found);  // as it was
}
