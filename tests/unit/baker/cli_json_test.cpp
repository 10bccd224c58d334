// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of the JSON that commands write, and that their values agree with each other.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "baked_human.h"
#include "human.h"
#include "play/asset_file.h"
#include "report/play_frames.h"
#include "spherechain/simd.h"
#include "temporary_folder.h"
#include "tool.h"

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

using tool::baked_files;
using tool::contents;
using tool::files_in;
using tool::pose;
using tool::Run;
using tool::run;

}  // namespace

TEST_CASE("inspect --json has the contract's fields and agrees with itself") {
  const Run inspect = run(fmt::format("inspect {} --json", baked_files().asset.string()));
  REQUIRE(inspect.code == 0);
  const json asset = json::parse(inspect.out);
  CHECK(asset["format_version"] == 1);
  CHECK(asset["writer"].get<std::string>().rfind("spherechain ", 0) == 0);
  CHECK(asset["source"]["file"] == "human.zae");
  CHECK(asset["source"]["sha256"].get<std::string>().size() == 64);
  CHECK(asset["source"]["triangles"] == 28796);
  REQUIRE(asset["spheres"].size() == asset["sphere_count"]);
  std::size_t triangles = 0, in_regions = 0, entries = 0;
  for (const json& sphere : asset["spheres"]) {
    for (const char* key :
         {"id", "center", "radius", "detect_radius", "region", "level", "side", "triangles", "pivots"})
      CHECK(sphere.contains(key));
    CHECK(sphere["pivots"].size() >= 8);
    triangles += sphere["triangles"].get<std::size_t>();
  }
  const std::vector<std::string> names{"left_arm", "right_arm", "left_leg", "right_leg", "torso"};
  for (std::size_t i = 0; i < names.size(); ++i) {
    CHECK(asset["regions"][i]["name"] == names[i]);
    in_regions += asset["regions"][i]["triangles"].get<std::size_t>();
  }
  CHECK(triangles == 28796);
  CHECK(in_regions == triangles);
  REQUIRE(asset["chains"].size() == 6);
  for (const json& chain : asset["chains"]) entries += chain["spheres"].size();
  CHECK(asset["chain_entries"] == entries);
  CHECK(asset["chain_entries_table1"] == baked_human().chains.entries_table1);
  CHECK(asset["ignored_pairs"] == baked_human().binding.ignored.size());
  for (const char* fit : {"phi1", "phi1_adjusted", "phi2"}) {
    CHECK(asset["fit"][fit].contains("mean_abs_F"));
    CHECK(asset["fit"][fit].contains("max_abs_F"));
  }
  CHECK(asset["bones"].size() == asset["joints"].size());
  CHECK(asset["bones"][0]["name"] == asset["joints"][0]["name"]);
  CHECK(asset["morphs"].empty());
  CHECK(asset["refit"] == "moments");
  CHECK(asset["bone_tables"]["bytes"] == 0);  // of pivots, which moments do without
  CHECK(asset["moment_tables"]["batches"] == baked_human().moments.batches.size());
  CHECK(asset["moment_tables"]["pairs"] > asset["moment_tables"]["batches"]);
  CHECK(asset["moment_tables"]["sphere_pairs"] > asset["moment_tables"]["sphere_bones"]);
  CHECK(asset["pivot_vertices"] > asset["sphere_count"]);
  const std::string text = run("inspect " + baked_files().asset.string()).out;
  CHECK(text.find("refit    moments\n") != std::string::npos);
  CHECK(text.find("\nmoments  ") != std::string::npos);
  CHECK(text.find("zeta5") != std::string::npos);
}

TEST_CASE("play --json is written frame by frame, and is the text that all of it at once would be") {
  using nlohmann::ordered_json;
  const TemporaryFolder folder;
  const fs::path out = folder.path / "play.json";
  const ordered_json head{{"backend", "simd"}, {"refit", "moments"}};
  ordered_json whole = head;
  // Names of clips are any bytes; lists may be empty, and lists of lists.
  whole["frames"] = {{{"index", 0}, {"pairs", ordered_json::array()}, {"m2", {{"tests", 3}}}},
                     {{"index", 1}, {"pairs", {{1, 2}, {3, 40}}}, {"clip", "a\nb \"c\", \xff {\n}"}},
                     {{"index", 2}, {"time", 0.1}, {"pairs", {{1, 2}}}}};
  const std::string text = whole.dump(1, ' ', false, ordered_json::error_handler_t::replace) + "\n";
  spherechain::baker::PlayFile file(out, head, 3);
  for (const ordered_json& frame : whole["frames"]) {
    CHECK(!fs::exists(out));
    file.add(frame);
    REQUIRE(files_in(folder.path) == 1);
    const std::string so_far = contents(fs::directory_iterator(folder.path)->path());
    CHECK(text.rfind(so_far, 0) == 0);
    CHECK(so_far.find(fmt::format("\"index\": {}", frame["index"].get<int>())) != std::string::npos);
  }
  CHECK(contents(out) == text);
}

TEST_CASE("play --json has the contract's fields; at rest nothing touches, hands on hips do") {
  const TemporaryFolder folder;
  const fs::path out = folder.path / "play.json";
  const auto play = [&](const std::string& more) {
    return run(
        fmt::format("play {} --source {} --json {} {}", baked_files().asset.string(), kHumanFile, out.string(), more));
  };
  REQUIRE(play(fmt::format("--poses {} --frames 5 --fps 10", pose("hands_on_hips.json"))).code == 0);
  const json both = json::parse(contents(out));
  CHECK(both["backend"] == (spherechain::best_target() == spherechain::Target::kScalar ? "scalar" : "simd"));
  CHECK(both["target"] == spherechain::to_string(spherechain::best_target()));
  CHECK(both["refit"] == "moments");
  REQUIRE(both["frames"].size() == 5);
  for (std::size_t i = 0; i < 5; ++i) {
    const json& frame = both["frames"][i];
    CHECK(frame["index"] == i);
    CHECK(frame["time"].get<double>() == doctest::Approx(0.1 * static_cast<double>(i)));
    CHECK(frame.contains("refit_us"));
    CHECK(frame["m1"]["unique_pairs"] <= frame["m2"]["pairs"]);
    CHECK(frame["m1"]["pairs"] >= frame["m1"]["unique_pairs"]);
    CHECK(frame["m2"]["pairs"] == frame["pairs"].size());
    CHECK(frame["m2"]["tests"] == both["frames"][0]["m2"]["tests"]);
    CHECK(frame["m1"].contains("us"));
    CHECK(frame.contains("skin_us"));
    CHECK(std::is_sorted(frame["skin_pairs"].begin(), frame["skin_pairs"].end()));
  }
  CHECK(both["frames"][0]["skin_pairs"].empty());
  CHECK(!both["frames"][4]["skin_pairs"].empty());
  CHECK(both["frames"][4]["skin_pairs"].size() < both["frames"][4]["pairs"].size());
  CHECK(both["frames"][0]["pairs"].empty());
  CHECK(!both["frames"][4]["pairs"].empty());

  CHECK(!both["frames"][4].contains("contacts"));
  const Run triangles = play(fmt::format("--contacts --poses {} --frames 5 --fps 10", pose("hands_on_hips.json")));
  REQUIRE(triangles.code == 0);
  CHECK(triangles.out.find("\ntriangles ") != std::string::npos);
  const json listed = json::parse(contents(out));
  const spherechain::baker::AssetFile file = spherechain::baker::open_asset(baked_files().asset.string());
  std::vector<json> owner(file.asset.info().source_triangle_count);
  for (std::size_t s = 0; s < file.asset.spheres().size; ++s) {
    const spherechain::RestSphere& sphere = file.asset.spheres()[s];
    for (std::uint32_t k = 0; k < sphere.triangle_count; ++k)
      owner[file.asset.triangles()[sphere.first_triangle + k]] = s;
  }
  CHECK(listed["frames"][0]["contacts"].empty());
  CHECK(listed["frames"][4].contains("contacts_us"));
  std::set<json> skin_pairs;  // of the spheres whose triangles they are
  for (const json& pair : listed["frames"][4]["contacts"]) {
    const json &a = owner.at(pair[0].get<std::size_t>()), &b = owner.at(pair[1].get<std::size_t>());
    skin_pairs.insert(a < b ? json{a, b} : json{b, a});
  }
  CHECK(skin_pairs ==
        std::set<json>(listed["frames"][4]["skin_pairs"].begin(), listed["frames"][4]["skin_pairs"].end()));

  const Run scalar = play("--frames 1 --mode m1 --radius fit --backend scalar");
  REQUIRE(scalar.code == 0);
  CHECK(scalar.out.find("1 frames, radius fit, refit moments, backend scalar\n") == 0);
  const json one = json::parse(contents(out));
  CHECK(one["frames"][0].contains("m1"));
  CHECK(!one["frames"][0].contains("m2"));
  CHECK(one["backend"] == "scalar");
  CHECK(one["target"] == "scalar");
}

TEST_CASE("validate --json has the contract's fields, the same with a cache and without") {
  const TemporaryFolder folder;
  const fs::path out = folder.path / "validate.json", cache = folder.path / "cache";
  const auto validate = [&](const std::string& more, const std::string& cached) {
    const Run done =
        run(fmt::format("validate {} --source {} --poses {} --frames 3 --json {} {}", baked_files().asset.string(),
                        kHumanFile, pose("arms_crossed.json"), out.string(), more),
            "SPHERECHAIN_CACHE=" + cached);
    REQUIRE_MESSAGE(done.code == 0, done.error);
    CHECK(done.out.find("pair recall") != std::string::npos);
    return json::parse(contents(out));
  };
  const json found = validate("", "off");
  CHECK(found["frames"] == 3);
  CHECK(found["radius"] == "detect");
  const json& left_out = found["out_of_scope"];
  for (const char* why : {"rest", "same_sphere", "ignored"}) CHECK(left_out[why] > 0);
  CHECK(found["raw_pairs"] == left_out["rest"].get<int>() + left_out["same_sphere"].get<int>() +
                                  left_out["ignored"].get<int>() + found["truth_pairs"].get<int>());
  CHECK(found["truth_pairs"] > 0);
  for (const char* share : {"pair_recall", "frame_any_recall", "frame_all_recall", "precision"}) {
    CHECK(found[share] >= 0);
    CHECK(found[share] <= 1);
  }
  CHECK(found["frame_any_recall"] == 1);
  CHECK(found["reported_per_frame"] > 0);
  CHECK(found["missed_depth"] == 0);
  CHECK(found["m2"]["missed_depth"] >= 0);
  CHECK(found["m2"]["missed_depth"] < 0.1);

  CHECK(validate("", cache.string()) == found);
  CHECK(files_in(cache) == 3);  // frame 0 is the rest pose
  CHECK(validate("", cache.string()) == found);
  CHECK(files_in(cache) == 3);
  json contacts = validate("--contacts", cache.string());
  CHECK(contacts["contacts_missing"] == 0);
  CHECK(contacts["contacts_extra"] == 0);
  CHECK(contacts["contacts_from_bones"]["missing"] == 0);
  CHECK(contacts["contacts_from_bones"]["extra"] == 0);
  for (const char* from : {"neighbour_contacts", "neighbour_contacts_from_bones"}) {
    CHECK(contacts[from]["missing"] == 0);
    CHECK(contacts[from]["extra"] == 0);
    contacts.erase(from);
  }
  contacts.erase("contacts_from_bones");
  contacts.erase("contacts_missing");
  contacts.erase("contacts_extra");
  CHECK(contacts == found);
  CHECK(found["skin"] == true);
  CHECK(found["precision"] == 1);
  CHECK(found["pair_recall"] == 1);
  CHECK(found["reported_per_frame"] < found["m2"]["reported_per_frame"]);
  const json alone = validate("--spheres-alone", cache.string());
  CHECK(alone["skin"] == false);
  for (const auto& [key, value] : alone["m2"].items()) CHECK(alone[key] == value);
  CHECK(alone["m2"] == found["m2"]);
  const json chains = validate("--mode m1 --radius fit", cache.string());
  CHECK(chains["truth_pairs"] == found["truth_pairs"]);
  CHECK(chains["radius"] == "fit");
  CHECK(chains["m1"]["pair_recall"] <= found["m2"]["pair_recall"]);
}

TEST_CASE("docs/json.md names every key that is written") {
  const std::string page = contents(SPHERECHAIN_SAMPLES "/../docs/json.md");
  const TemporaryFolder folder;
  const fs::path out = folder.path / "out.json";
  const auto named = [&](const json& value, const auto& self) -> void {
    if (!value.is_structured()) return;
    for (const auto& [key, inner] : value.items()) {
      if (value.is_object()) CHECK_MESSAGE(page.find("`" + key + "`") != std::string::npos, key);
      if (key != "settings") self(inner, self);  // README.md has those
    }
  };
  const auto written = [&](const char* command) {
    const Run done = run(fmt::format("{} {} --source {} --poses {} --frames 2 --contacts --json {}", command,
                                     baked_files().asset.string(), kHumanFile, pose("arms_crossed.json"), out.string()),
                         "SPHERECHAIN_CACHE=off");
    REQUIRE_MESSAGE(done.code == 0, done.error);
    return json::parse(contents(out));
  };
  named(written("play"), named);
  named(written("validate"), named);
  named(json::parse(run(fmt::format("inspect {} --json", baked_files().asset.string())).out), named);
  named(json::parse(run("inspect --json --roles /usr/share/assimp/models/X/Testwuson.X").out), named);
  const json report = json::parse(contents(baked_files().report));
  for (const auto& [key, value] : report.items()) {
    CHECK_MESSAGE(page.find("`" + key + "`") != std::string::npos, key);
  }
}
