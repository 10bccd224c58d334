// SPDX-License-Identifier: GPL-3.0-or-later
// The size of a character that its file has wrong: --scale and --height, and the note that names them.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "baker/pipeline/pipeline.h"
#include "human.h"
#include "tool.h"

using nlohmann::json;

namespace {

// A power of two: positions in single precision stay as exact as they are.
constexpr double kTooLarge = 16;

// The human as it is and too large, with answers of the tool on both.
struct Sizes {
  TemporaryFolder folder;
  std::string right = human_of("right", 1), large = human_of("large", kTooLarge);
  double height = human().regions.frame.height;

  std::string human_of(const char* name, double scale) const {
    std::string obj;
    for (const auto& p : human().character.source_positions) {
      obj += fmt::format("v {:.9g} {:.9g} {:.9g}\n", scale * p.x(), scale * p.y(), scale * p.z());
    }
    for (const auto& t : human().character.source_triangles) {
      obj += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    }
    return folder.write(std::string(name) + ".obj", obj).string();
  }
  std::string path(const std::string& name) const { return (folder.path / name).string(); }
  tool::Run bake(const std::string& source, const std::string& name, const std::string& more = {}) const {
    return tool::run(fmt::format("bake {} -o {} {}", source, path(name), more));
  }
  json check(const std::string& source, const std::string& name, const std::string& more, std::string* out) const {
    const tool::Run run = tool::run(fmt::format(
        "check {} -o {} --motion /usr/share/assimp/models/BVH/01_01.bvh --fps 4 --fail-on none --json {} {}", source,
        path(name), path(name + ".json"), more));
    REQUIRE_MESSAGE(run.code == 0, run.error);
    if (out != nullptr) *out = run.out + run.error;
    return json::parse(tool::contents(path(name + ".json")));
  }
};

int notes_in(const std::string& text) {
  int count = 0;
  for (std::size_t at = 0; (at = text.find("this biped is", at)) != std::string::npos; ++at) ++count;
  return count;
}

void check_same_events(const json& a, const json& b) {
  REQUIRE(a["clips"].size() == 1);
  REQUIRE(b["clips"].size() == 1);
  const json &these = a["clips"][0]["events"], &those = b["clips"][0]["events"];
  REQUIRE(!these.empty());
  REQUIRE(these.size() == those.size());
  for (std::size_t i = 0; i < these.size(); ++i) {
    for (const char* key : {"parts", "class", "from", "to"}) CHECK(these[i][key] == those[i][key]);
    CHECK(these[i]["depth_mm"].get<double>() == doctest::Approx(those[i]["depth_mm"].get<double>()).epsilon(1e-3));
  }
}

}  // namespace

TEST_CASE("a biped that is too large is noted once with the remedy, and with --height it has the right size's answers" *
          doctest::test_suite("many bakes")) {
  const Sizes sizes;
  std::string said;
  const json right = sizes.check(sizes.right, "right", "", &said);
  CHECK(notes_in(said) == 0);
  const json large = sizes.check(sizes.large, "large", "", &said);
  CHECK(notes_in(said) == 1);
  REQUIRE(large["notes"].size() == 1);
  const std::string note = large["notes"][0];
  CHECK(
      note.starts_with(fmt::format("large.obj: this biped is {:.4g} m tall: --height 1.7", kTooLarge * sizes.height)));
  const json resized = sizes.check(sizes.large, "resized", fmt::format("--height {:.9g}", sizes.height), &said);
  CHECK(notes_in(said) == 0);
  CHECK(resized["notes"].empty());
  check_same_events(right, resized);
}

TEST_CASE("an asset keeps the size that bake was given: play and export answer in it" *
          doctest::test_suite("many bakes")) {
  const Sizes sizes;
  REQUIRE(sizes.bake(sizes.right, "right.sphc").code == 0);
  const tool::Run large = sizes.bake(sizes.large, "large.sphc");
  CHECK(notes_in(large.out + large.error) == 1);
  const tool::Run scaled = sizes.bake(sizes.large, "scaled.sphc", fmt::format("--scale {}", 1 / kTooLarge));
  REQUIRE_MESSAGE(scaled.code == 0, scaled.error);
  CHECK(notes_in(scaled.out + scaled.error) == 0);
  CHECK(scaled.out.find(fmt::format("{:.3f} m tall", sizes.height)) != std::string::npos);

  const auto penetrations = [&](const std::string& asset, const std::string& source) {
    const std::string out = sizes.path(asset + ".json");
    const tool::Run run = tool::run(fmt::format("play {} --source {} --poses {} --frames 12 --json {}",
                                                sizes.path(asset), source, tool::pose("arms_crossed.json"), out));
    REQUIRE_MESSAGE(run.code == 0, run.error);
    std::vector<std::pair<std::string, double>> found;
    const json played = json::parse(tool::contents(out));
    for (const json& frame : played["frames"]) {
      for (const json& one : frame["penetrations"]) found.emplace_back(one["class"], one["depth_mm"]);
    }
    return found;
  };
  const auto expected = penetrations("right.sphc", sizes.right), found = penetrations("scaled.sphc", sizes.large);
  REQUIRE(!expected.empty());
  REQUIRE(expected.size() == found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    CHECK(found[i].first == expected[i].first);
    CHECK(found[i].second == doctest::Approx(expected[i].second).epsilon(1e-3));
  }

  const auto exported = [&](const std::string& asset, const std::string& more, int notes) {
    const tool::Run run =
        tool::run(fmt::format("export {} --to mjcf -o {} --force {}", sizes.path(asset), sizes.path("out.xml"), more));
    REQUIRE_MESSAGE(run.code == 0, run.error);
    CHECK(notes_in(run.out + run.error) == notes);
    return tool::contents(sizes.path("out.xml"));
  };
  const std::string of_scaled = exported("scaled.sphc", "", 0);
  const std::string of_large = exported("large.sphc", "", 1);
  CHECK(of_large != of_scaled);
  CHECK(exported("large.sphc", "--scale 1", 0) == of_large);
  CHECK(exported("large.sphc", fmt::format("--scale {}", 1 / kTooLarge), 0) == of_scaled);
}

TEST_CASE("a size is a number above 0, and one of two") {
  for (const char* command : {"bake x.glb -o x.sphc", "check x.glb -o x", "export x.sphc --to mjcf -o x.xml"}) {
    for (const char* size : {"--scale 0", "--scale nan", "--scale inf", "--height -1", "--height tall"}) {
      tool::check_error(tool::run(fmt::format("{} {}", command, size)), 2, {std::string(size).substr(0, 7)});
    }
    tool::check_error(tool::run(fmt::format("{} --scale 2 --height 2", command)), 2, {"--scale", "--height"});
  }
  tool::check_error(tool::run("check x -o y --merge --height 2"), 2, {"--merge", "--height"});
  using spherechain::baker::make_settings;
  CHECK(make_settings("balanced", R"({"height": 1.7})", "").size.height == 1.7);
  CHECK_THROWS_WITH_AS(make_settings("balanced", R"({"scale": 2, "height": 1.7})", "c.json"),
                       "c.json: setting 'scale' does not go with 'height'", spherechain::baker::Error);
}
