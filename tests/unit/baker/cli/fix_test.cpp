// SPDX-License-Identifier: GPL-3.0-or-later
// `spherechain fix`: an arm beside a wall, of which it is known how far it has to turn.
#include <doctest/doctest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "baker/fix/turned_clip.h"
#include "baker/import/import.h"
#include "baker/motion/clip.h"
#include "glb_writer.h"
#include "temporary_folder.h"
#include "tool.h"
#include "two_shapes.h"
#include "wall_and_arm.h"

using namespace spherechain::baker;
using nlohmann::json;

namespace {

struct Fixed {
  tool::Run run;
  std::string before, after;
  json report;
  std::vector<double> degrees;  // of the arm in each frame, after
};

Fixed fix(const std::vector<double>& degrees, const std::string& options = {}) {
  const TemporaryFolder folder;
  Fixed out;
  out.before = wall_and_arm(degrees);
  const auto file = folder.write("arm.glb", out.before), fixed = folder.path / "fixed.glb";
  folder.write("keep.json", R"({"allow": [{"parts": ["wall", "paddle"], "depth_mm": 500}]})");
  out.run =
      tool::run("fix " + file.string() + " -o " + fixed.string() + " --report " + (folder.path / "report").string() +
                " " + (options == "keep" ? "--keep " + (folder.path / "keep.json").string() : options));
  CHECK_MESSAGE(out.run.error == "", out.run.error);
  out.after = tool::contents(fixed);
  out.report = json::parse(tool::contents(folder.path / "report/fix.json"));
  // `check` finds faults where this says that some are left.
  tool::run("check " + fixed.string() + " -o " + (folder.path / "check").string() + " --continuous --json " +
            (folder.path / "check.json").string());
  const json checked = json::parse(tool::contents(folder.path / "check.json"));
  bool is_left = false;
  for (const json& event : out.report["clips"][0]["events"]) is_left |= event["depth_mm_after"] > 0;
  CHECK((checked["summary"]["penetrations"] > 0) == is_left);
  const Character character = import_character(fixed);
  for (std::size_t f = 0; f < degrees.size(); ++f) {
    const auto world = world_at(character.rig, character.rig.clips[0], static_cast<double>(f) / 30);
    const auto m = world[2].linear();
    out.degrees.push_back(std::atan2(m(0, 1), m(0, 0)) * 180 / std::numbers::pi);
  }
  return out;
}

}  // namespace

TEST_CASE("fix: an arm that is turned into a wall comes back by as much, and no further") {
  const Fixed fixed = fix(std::vector<double>(30, 5));
  CHECK(fixed.run.code == 0);
  for (const double degrees : fixed.degrees) CHECK(std::abs(degrees) < 0.2);
  const json clip = fixed.report["clips"][0];
  REQUIRE(clip["events"].size() == 1);
  CHECK(clip["clip"] == "swing");
  CHECK(clip["events"][0]["outcome"] == "cleared");
  CHECK(clip["events"][0]["depth_mm_before"].get<double>() == doctest::Approx(68).epsilon(0.05));
  CHECK(clip["events"][0]["depth_mm_after"] == 0);
  CHECK(clip["volume_cm3_before"].get<double>() > 1);
  CHECK(clip["volume_cm3_after"] == 0);
  CHECK(clip["turn_degrees"]["max"].get<double>() == doctest::Approx(2.5).epsilon(0.04));  // two joints share it
}

TEST_CASE("fix: a fault in a clean clip is undone around it, and nothing else of the file changes") {
  std::vector<double> degrees(120, -10);
  for (int f = 56; f <= 64; ++f) degrees[static_cast<std::size_t>(f)] = 12 - 1.2 * std::abs(f - 60);
  const Fixed fixed = fix(degrees);
  CHECK(fixed.run.code == 0);
  for (int f = 0; f < 120; ++f) {
    const double after = fixed.degrees[static_cast<std::size_t>(f)], before = degrees[static_cast<std::size_t>(f)];
    CHECK(after < 0.2);
    if (std::abs(f - 60) > 20) CHECK(std::abs(after - before) < 1e-4);
  }
  // Its numbers come first, as they were; its JSON keeps what it says.
  const auto binary = [](const std::string& glb) {
    std::uint32_t size = 0;
    std::memcpy(&size, glb.data() + 12, 4);
    return std::pair(json::parse(glb.substr(20, size)), glb.substr(20 + size + 8));
  };
  const auto [json_before, bytes_before] = binary(fixed.before);
  const auto [json_after, bytes_after] = binary(fixed.after);
  CHECK(bytes_after.substr(0, bytes_before.size()) == bytes_before);
  CHECK(json_after["nodes"] == json_before["nodes"]);
  CHECK(json_after["meshes"] == json_before["meshes"]);
  CHECK(json_after["animations"][0]["channels"][1] == json_before["animations"][0]["channels"][1]);
}

TEST_CASE("fix: what a budget cannot cure takes nothing from the frames around, and more budget makes nothing worse") {
  std::vector<double> degrees(150, 5);
  for (int f = 70; f < 80; ++f) degrees[static_cast<std::size_t>(f)] = 40;
  double before = HUGE_VAL;
  for (const char* const budget : {"3", "6", "12", "30"}) {
    const Fixed fixed = fix(degrees, std::string("--budget ") + budget);
    double left = 0;
    int cured = 0;
    for (const double after : fixed.degrees) {
      left += std::max(after, 0.0);
      cured += after < 0.2 ? 1 : 0;
    }
    CHECK(left <= before);
    CHECK(cured > 75);
    before = left;
    CHECK(fixed.report["clips"][0]["events"][0]["outcome"] == (cured == 150 ? "cleared" : "reduced"));
  }
  CHECK(before < 2);
}

TEST_CASE("fix: a loop stays one" * doctest::test_suite("long runs")) {
  std::vector<double> degrees(60, -10);
  for (int f = 52; f <= 58; ++f) degrees[static_cast<std::size_t>(f)] = 12;  // near its seam, on one side
  const Fixed fixed = fix(degrees);
  for (const double after : fixed.degrees) CHECK(after < 0.2);
  CHECK(std::abs(fixed.degrees.front() - fixed.degrees.back()) < 0.1);
}

TEST_CASE("fix: what has no fault, is meant, or costs more than the budget, stays byte for byte" *
          doctest::test_suite("long runs")) {
  const Fixed clean = fix(std::vector<double>(30, -10));
  CHECK(clean.run.code == 0);
  CHECK(clean.after == clean.before);
  CHECK(clean.report["clips"][0]["events"].empty());
  CHECK(clean.run.out.find("1 of 1 clip has no event") != std::string::npos);

  const Fixed kept = fix(std::vector<double>(30, 5), "keep");
  CHECK(kept.run.code == 0);
  CHECK(kept.after == kept.before);
  REQUIRE(kept.report["clips"][0]["events"].size() == 1);
  CHECK(kept.report["clips"][0]["events"][0]["outcome"] == "accepted");

  const Fixed dear = fix(std::vector<double>(30, 20), "--budget 1");
  CHECK(dear.run.code == 5);
  CHECK(dear.after == dear.before);
  REQUIRE(dear.report["clips"][0]["events"].size() == 1);
  CHECK(dear.report["clips"][0]["events"][0]["outcome"] == "over_budget");
  // The budget that it names is enough.
  const std::string advice = "over_budget: joints would turn farther than they may (try --budget ";
  const std::size_t at = dear.run.out.find(advice);
  REQUIRE_MESSAGE(at != std::string::npos, dear.run.out);
  const double budget = std::stod(dear.run.out.substr(at + advice.size()));
  CHECK(budget >= 10);  // two joints share the way
  CHECK(budget < 40);
  const Fixed enough = fix(std::vector<double>(30, 20), "--budget " + std::to_string(budget));
  CHECK_MESSAGE(enough.run.code == 0, enough.run.out);

  const Fixed less = fix(std::vector<double>(30, 20), "--budget 8");
  CHECK(less.run.code == 5);
  const json event = less.report["clips"][0]["events"][0];
  CHECK(event["outcome"] == "reduced");
  CHECK(event["depth_mm_after"].get<double>() < 0.4 * event["depth_mm_before"].get<double>());
  CHECK(less.report["clips"][0]["turn_degrees"]["max"].get<double>() <= 8.001);
}

TEST_CASE("fix: a report folder is written again; what cannot be written is refused, and nothing is written") {
  const TemporaryFolder folder;
  const auto file = folder.write("arm.glb", wall_and_arm({5, 5, 5}));
  const std::string again = "fix " + file.string() + " -o " + (folder.path / "again.glb").string() + " --report " +
                            (folder.path / "report").string();
  CHECK(tool::run(again).code == 0);
  CHECK(tool::run(again).code == 0);
  folder.write("report/clip_art.html", "mine");
  tool::check_error(tool::run(again), 3, {"clip_art.html: exists and is not what spherechain wrote"});
  CHECK(tool::contents(folder.path / "report/clip_art.html") == "mine");
  const std::string out = " -o " + (folder.path / "out.glb").string();
  Glb still;
  const int wall = mesh_of(still, box(0.5, 1, 1), 0, 0);
  still.json["nodes"] = {{{"name", "wall"}, {"mesh", wall}}};
  tool::check_error(tool::run("fix " + folder.write("still.glb", still.bytes()).string() + out), 3,
                    {"still.glb", "no clips"});
  tool::check_error(tool::run("fix /usr/share/assimp/models/BVH/01_01.bvh" + out), 3, {"01_01.bvh"});
  tool::check_error(tool::run("fix " + file.string() + out + " --clip other"), 3, {"other"});
  tool::check_error(tool::run("fix " + file.string() + " -o " + file.string()), 2, {"arm.glb"});
  tool::check_error(tool::run("fix " + file.string() + " -o " + (folder.path / "out.gltf").string()), 2, {".glb"});
  tool::check_error(tool::run("fix " + file.string() + out + " --report " + file.string()), 3, {"no folder"});
  CHECK(!std::filesystem::exists(folder.path / "out.glb"));
}

TEST_CASE("fix: a file of another format is mended as a binary glTF" * doctest::test_suite("long runs")) {
  const TemporaryFolder folder;
  const std::string source = "/usr/share/assimp/models/FBX/huesitos.fbx", out = (folder.path / "out.glb").string();
  const auto penetrations = [&](const std::string& file, const char* name) {
    return tool::run("check " + file + " -o " + (folder.path / name).string()).out;
  };
  CHECK(penetrations(source, "before").find("1 penetration in 1 ticket;") != std::string::npos);
  const tool::Run run = tool::run("fix " + source + " -o " + out + " --report " + (folder.path / "report").string());
  CHECK_MESSAGE(run.code == 0, run.error);
  CHECK(run.out.find("1 cleared") != std::string::npos);
  CHECK(penetrations(out, "after").find("0 penetrations;") != std::string::npos);
  CHECK(import_character(out).source_positions == import_character(source).source_positions);
}

TEST_CASE("fix: an FBX stays one where it is asked for, mended as its GLB is" * doctest::test_suite("long runs")) {
  const TemporaryFolder folder;
  const std::string source = "/usr/share/assimp/models/FBX/huesitos.fbx", out = (folder.path / "out.fbx").string();
  const tool::Run run = tool::run("fix " + source + " -o " + out);
  CHECK_MESSAGE(run.code == 0, run.error);
  CHECK(tool::run("check " + out + " -o " + (folder.path / "after").string()).out.find("0 penetrations;") !=
        std::string::npos);
  CHECK(tool::contents(out).starts_with("Kaydara FBX Binary"));
  tool::check_error(tool::run("fix " + source + " -o " + out), 3, {"out.fbx", "--force"});
}

TEST_CASE("fix: an FBX is written of an FBX alone, and of a whole one") {
  const TemporaryFolder folder;
  const std::string source = "/usr/share/assimp/models/FBX/huesitos.fbx", out = (folder.path / "out.fbx").string();
  const auto glb = folder.write("arm.glb", wall_and_arm({5, 5, 5}));
  tool::check_error(tool::run("fix " + glb.string() + " -o " + out), 2, {"arm.glb", "no FBX"});
  tool::check_error(tool::run("fix " + source + " -o " + out + " --motion /usr/share/assimp/models/BVH/01_01.bvh"), 2,
                    {"out.fbx", "--motion"});
  const auto cut = folder.write("cut.fbx", tool::contents(source).substr(0, 100000));
  tool::check_error(tool::run("fix " + cut.string() + " -o " + out), 3, {"cut.fbx", "damaged"});
  CHECK(!std::filesystem::exists(out));
}

TEST_CASE("fix: clips of one name have a page each") {
  const TemporaryFolder folder;
  const std::string report = (folder.path / "report").string();
  tool::run("fix " + folder.write("arm.glb", wall_and_arm({5, 5}, 3)).string() + " -o " +
            (folder.path / "out.glb").string() + " --report " + report);
  const json fixed = json::parse(tool::contents(report + "/fix.json"));
  if (!std::filesystem::exists(report + "/clip_0.html")) return;  // built without the page
  std::set<std::string> pages;
  for (const int clip : {0, 1, 2}) {
    CHECK(fixed["clips"][clip]["clip"] == "swing");
    pages.insert(tool::contents(report + "/clip_" + std::to_string(clip) + ".html"));
  }
  CHECK(pages.size() == 3);
}

TEST_CASE("fix: a point of the skin moves with a turn as its derivative says") {
  const TemporaryFolder folder;
  const Character character = import_character(folder.write("arm.glb", wall_and_arm(std::vector<double>(9, 5))));
  const TurnedClip clip(character.rig, character.rig.clips[0], 30, 9, {{2, Eigen::Matrix3d::Identity(), {}}});
  const SkinSpot spot{character.source_triangles.back(), {0.2, 0.3, 0.5}};
  const auto at = [&](const Vec3& turn) {
    const Turns turns(9, turn);
    const TurnedClip::Pose pose = clip.pose(3.5, turns);
    return motion_of(clip, pose, character.source_positions, character.rig.weights, spot, &turn);
  };
  for (const Vec3& turn : {Vec3(0, 0, 0), Vec3(0.3, -0.2, 0.5), Vec3(-0.9, 0.4, 0.1)}) {
    const SpotMotion here = at(turn);
    REQUIRE(here.by_joint.size() == 1);
    for (int k = 0; k < 3; ++k) {
      const double step = 1e-5;
      const Vec3 numeric = (at(turn + step * Vec3::Unit(k)).at - at(turn - step * Vec3::Unit(k)).at) / (2 * step);
      CHECK((here.by_joint[0].second.col(k) - numeric).norm() < 1e-8);
    }
  }
}
