// SPDX-License-Identifier: GPL-3.0-or-later
// `spherechain fix --motion`: a recording, mended on a character and in its own file. And what may be left alone.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "baker/fix/bvh_text.h"
#include "baker/import/import.h"
#include "baker/motion/clip.h"
#include "temporary_folder.h"
#include "tool.h"
#include "wall_and_arm.h"

using namespace spherechain::baker;
using nlohmann::json;
namespace fs = std::filesystem;

namespace {

// Frames 56 to 64 are in the wall, the others 10 degrees away from it.
std::vector<double> planted_fault() {
  std::vector<double> out(120, -10);
  for (int f = 56; f <= 64; ++f) out[static_cast<std::size_t>(f)] = 12 - 1.2 * std::abs(f - 60);
  return out;
}

Eigen::AlignedBox3d bounds_of(const std::vector<Vec3>& positions) {
  Eigen::AlignedBox3d out;
  for (const Vec3& p : positions) out.extend(p);
  return out;
}

struct Files {
  TemporaryFolder folder;
  fs::path character, take;
  Files()
      : character(folder.write("arm.glb", wall_and_arm(std::vector<double>(5, -20)))),
        take(folder.write("take 1.bvh", recording_of_arm(planted_fault()))) {}
  std::string path(const char* name) const { return (folder.path / name).string(); }
  tool::Run fix(const std::string& more) const {
    return tool::run("fix " + character.string() + " --motion '" + take.string() + "' " + more);
  }
  json report() const { return json::parse(tool::contents(folder.path / "report/fix.json"))["clips"]; }
};

}  // namespace

TEST_CASE("fix: a recording becomes a clip of the character, mended; its own clip stays") {
  const Files files;
  const tool::Run run = files.fix("-o " + files.path("out.glb") + " --report " + files.path("report"));
  CHECK_MESSAGE(run.code == 0, run.error);
  CHECK(files.report()[0]["clip"] == "take 1");
  REQUIRE(files.report()[0]["events"].size() == 1);
  CHECK(files.report()[0]["events"][0]["outcome"] == "cleared");
  const json before = json_of(tool::contents(files.character)), after = json_of(tool::contents(files.path("out.glb")));
  REQUIRE(after["animations"].size() == 2);
  CHECK(after["animations"][0] == before["animations"][0]);
  CHECK(after["nodes"] == before["nodes"]);
  const Character character = import_character(files.path("out.glb"));
  const Clip& clip = character.rig.clips[1];
  CHECK(clip.name == "take 1");
  const std::vector<double> degrees = planted_fault();
  for (int f = 0; f < 120; ++f) {
    const Eigen::Matrix3d m = world_at(character.rig, clip, f / 30.0)[2].linear();
    const double now = std::atan2(m(0, 1), m(0, 0)) * 180 / std::numbers::pi;
    CHECK(now < 0.2);
    if (std::abs(f - 60) > 20) CHECK(std::abs(now - degrees[static_cast<std::size_t>(f)]) < 1e-3);
  }
  // Another take of that name stands beside it.
  CHECK(tool::run("fix " + files.path("out.glb") + " --motion '" + files.take.string() + "' -o " +
                  files.path("twice.glb"))
            .code == 0);
  CHECK(json_of(tool::contents(files.path("twice.glb")))["animations"][2]["name"] == "take 1 (2)");
}

TEST_CASE("fix: a BVH recording is written again with other angles around the fault, and nothing else") {
  const Files files;
  const tool::Run run = files.fix("-o " + files.path("out.bvh"));
  CHECK_MESSAGE(run.code == 0, run.error);
  CHECK(run.out.find("carried over again, the skin is within 0.0") != std::string::npos);
  const std::string before = tool::contents(files.take), after = tool::contents(files.path("out.bvh"));
  std::istringstream before_lines(before), after_lines(after);
  int line = 0, changed = 0;
  for (std::string a, b; std::getline(before_lines, a) && std::getline(after_lines, b); ++line) {
    changed += a != b ? 1 : 0;
    if (std::abs(line - 23 - 60) > 20) CHECK(a == b);
  }
  CHECK(line == 23 + 120);
  CHECK(changed > 9);
  const BvhText bvh(after, "out.bvh");
  for (int f = 0; f < bvh.frames(); ++f) {
    const Eigen::Quaterniond turn = bvh.rotation(f, bvh.joints()[1]) * bvh.rotation(f, bvh.joints()[2]);
    CHECK(-2 * std::atan2(turn.z(), turn.w()) * 180 / std::numbers::pi < 0.2);
  }
  const tool::Run again = tool::run("fix " + files.character.string() + " --motion " + files.path("out.bvh") + " -o " +
                                    files.path("again.bvh"));
  CHECK(again.out.find("1 of 1 clip has no event") != std::string::npos);
  CHECK(tool::contents(files.path("again.bvh")) == after);
}

TEST_CASE("fix: a recording that names a wrong number of frames, or none, is written with the right one" *
          doctest::test_suite("long runs")) {
  const Files files;
  const std::string right = tool::contents(files.take), stated = "Frames: 120\n";
  const std::size_t at = right.find(stated);
  REQUIRE(at != std::string::npos);
  const auto mended = [&](const std::string& header) {
    files.folder.write("take 1.bvh", right.substr(0, at) + header + right.substr(at + stated.size()));
    CHECK(files.fix("--force -o " + files.path("out.bvh")).code == 0);
    return tool::contents(files.path("out.bvh"));
  };
  const std::string expected = mended(stated);
  for (const char* header : {"Frames: 7\n", "Frames: 119\n", "Frames: 4000\n", "Frames: many\n", ""}) {
    CAPTURE(header);
    CHECK(mended(header) == expected);
  }
  CHECK(mended("FRAMES:\t120.0 \n").find("FRAMES:\t120 \n") != std::string::npos);
}

TEST_CASE("fix: what cannot be written from a recording is refused, and nothing is written") {
  const Files files;
  const std::string out = "-o " + files.path("out.bvh");
  tool::check_error(tool::run("fix " + files.character.string() + " " + out), 2, {"out.bvh", "--motion"});
  tool::check_error(tool::run("fix " + files.character.string() + " --motion " + files.character.string() + " " + out),
                    2, {"out.bvh", "a BVH alone"});
  tool::check_error(files.fix("--clip swing " + out), 2, {"--clip", "--motion"});
  tool::check_error(files.fix("-o '" + files.take.string() + "'"), 2, {"take 1.bvh", "same file"});
  files.folder.write("out.bvh", "somebody's notes");
  tool::check_error(files.fix(out), 3, {"out.bvh", "not a BVH file"});
  CHECK(tool::contents(files.path("out.bvh")) == "somebody's notes");
  tool::check_error(tool::run("fix " + files.character.string() + " --motion " + files.folder.path.string() + " -o " +
                              files.path("out.glb")),
                    2, {"--motion", "is a folder"});
  // A joint that has to turn and has one angle alone.
  files.folder.write("take 1.bvh", recording_of_arm(planted_fault(), true));
  tool::check_error(files.fix("-o " + files.path("hinge.bvh")), 3, {"take 1.bvh: the joint '", "three axes"});
  CHECK(!fs::exists(files.path("hinge.bvh")));
  CHECK(files.fix("-o " + files.path("hinge.glb")).code == 0);
  // Before the character is baked, the recording is read.
  files.folder.write("take 1.bvh", "HIERARCHY");
  files.folder.write("none.glb", "no character");
  tool::check_error(tool::run("fix " + files.path("none.glb") + " --motion '" + files.take.string() + "' -o " +
                              files.path("none_mended.glb")),
                    3, {"take 1.bvh: ends before its motion"});
}

TEST_CASE("fix: a character without bones is mended on its automatic rig, which its GLB then has" *
          doctest::test_suite("long runs")) {
  const TemporaryFolder folder;
  const std::string models = "/usr/share/assimp/models/", human = models + "Collada/human.zae",
                    whole = tool::contents(models + "BVH/01_01.bvh"), stated = "Frames: 2752";
  // The first 48 frames: in 40 of them a hand is in the head.
  std::size_t end = whole.find(stated);
  REQUIRE(end != std::string::npos);
  const std::size_t header = end;
  for (int line = 0; line < 50; ++line) end = whole.find('\n', end) + 1;
  const auto take = folder.write("take.bvh", whole.substr(0, header) + "Frames: 48" +
                                                 whole.substr(header + stated.size(), end - header - stated.size()));
  const std::string in = folder.path.string() + "/", of_take = human + " --motion " + take.string();
  const tool::Run run = tool::run("fix " + of_take + " -o " + in + "out.glb --report " + in + "fixed");
  CHECK_MESSAGE(run.code == 0, run.error);
  CHECK(run.out.find("take: 1 event, 1 cleared") != std::string::npos);
  // The GLB's joints carry the recording as the automatic rig does: hands lie where `check` sees them.
  tool::run("check " + of_take + " -o " + in + "checked --json " + in + "check.json");
  const auto deepest = [&](const char* file, const char* key) {
    return json::parse(tool::contents(in + file))["clips"][0]["events"][0][key].get<double>();
  };
  CHECK(deepest("fixed/fix.json", "depth_mm_before") ==
        doctest::Approx(deepest("check.json", "depth_mm")).epsilon(0.01));
  const Character before = import_character(human), after = import_character(folder.path / "out.glb");
  CHECK(after.source_triangles == before.source_triangles);
  CHECK(after.rig.bones.size() == 19);
  const auto blended = std::count_if(after.rig.weights.begin(), after.rig.weights.end(),
                                     [](const VertexWeights& weights) { return weights.weight[1] > 0.1; });
  CHECK(blended > 1000);  // the skin bends
  REQUIRE(after.rig.clips.size() == 1);
  const Eigen::AlignedBox3d was = bounds_of(before.source_positions), is = bounds_of(after.source_positions);
  CHECK(is.diagonal().norm() == doctest::Approx(before.metres_per_unit * was.diagonal().norm()));
}

TEST_CASE("fix: what a baseline accepts is left; what is worse than that is not" * doctest::test_suite("long runs")) {
  const TemporaryFolder folder;
  const auto file = folder.write("arm.glb", wall_and_arm(std::vector<double>(30, 5)));
  const std::string baseline = (folder.path / "baseline.json").string(), out = (folder.path / "out.glb").string();
  CHECK(tool::run("check " + file.string() + " -o " + (folder.path / "report").string() + " --accept --baseline " +
                  baseline)
            .code == 0);
  const tool::Run run = tool::run("fix " + file.string() + " -o " + out + " --baseline " + baseline);
  CHECK_MESSAGE(run.code == 0, run.error);
  CHECK(run.out.find("1 event, 1 accepted") != std::string::npos);
  CHECK(tool::contents(out) == tool::contents(file));
  const auto with = [&](const char* key, const json& value) {
    json changed = json::parse(tool::contents(baseline));
    changed["spherechain_baseline"][0][key] = value;
    return tool::run("fix " + file.string() + " -o " + out + " --baseline " +
                     folder.write("changed.json", changed.dump()).string());
  };
  CHECK(with("state", "known").out.find("1 cleared") != std::string::npos);
  CHECK(with("depth_mm", 30).out.find("1 cleared") != std::string::npos);
  CHECK(with("clip", "swi").out.find("1 cleared") != std::string::npos);
  CHECK(with("character", "other.glb").out.find("1 cleared") != std::string::npos);
  CHECK(with("from_seconds", 2).out.find("1 accepted") != std::string::npos);  // over a loop's seam
  tool::check_error(tool::run("fix " + file.string() + " -o " + out + " --baseline " + file.string()), 3,
                    {"arm.glb", "no baseline"});
}

TEST_CASE("fix: only faults of the parts that are asked for are mended" * doctest::test_suite("long runs")) {
  const TemporaryFolder folder;
  const auto file = folder.write("arm.glb", wall_and_arm(std::vector<double>(30, 5)));
  const std::string out = (folder.path / "out.glb").string(), start = "fix " + file.string() + " -o " + out;
  const tool::Run other = tool::run(start + " --parts block");
  CHECK(other.code == 0);
  CHECK(other.out.find("swing: 0 events; 1 of other parts") != std::string::npos);
  CHECK(tool::contents(out) == tool::contents(file));
  CHECK(tool::run(start + " --parts block,paddle").out.find("1 cleared") != std::string::npos);
  tool::check_error(tool::run(start + " --parts fin"), 2, {"--parts", "'fin'", "block, paddle"});
}
