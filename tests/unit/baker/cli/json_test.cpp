// SPDX-License-Identifier: GPL-3.0-or-later
// The keys of the JSON that commands write, and that their values agree with each other.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "baked_human.h"
#include "baker/report/play_frames.h"
#include "human.h"
#include "runtime/src/simd/simd.h"
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
  CHECK(asset["format_version"] == 7);
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
  std::size_t in_parts = 0;
  for (const json& part : asset["parts"]) {
    in_parts += part["triangles"].get<std::size_t>();
    for (const char* key : {"name", "side", "bone"}) CHECK(part.contains(key));
  }
  CHECK(in_parts == triangles);
  REQUIRE(asset["chains"].size() == 6);
  for (const json& chain : asset["chains"]) entries += chain["spheres"].size();
  CHECK(asset["chain_entries"] == entries);
  CHECK(asset["ignored_pairs"] == baked_human().binding.ignored.size());
  for (const char* fit : {"phi1", "phi1_adjusted", "phi2"}) {
    CHECK(asset["fit"][fit].contains("mean_abs_F"));
    CHECK(asset["fit"][fit].contains("max_abs_F"));
  }
  CHECK(asset["bones"].size() == asset["joints"].size());
  CHECK(asset["bones"][0]["name"] == asset["joints"][0]["name"]);
  CHECK(asset["morphs"].empty());
  CHECK(asset["refit"] == "moments");
  CHECK(asset["moment_tables"]["batches"] == baked_human().moments.batches.size());
  CHECK(asset["moment_tables"]["pairs"] > asset["moment_tables"]["batches"]);
  CHECK(asset["moment_tables"]["sphere_pairs"] > asset["moment_tables"]["sphere_bones"]);
  CHECK(asset["skin"]["clusters"] > asset["sphere_count"]);
  const std::string text = run("inspect " + baked_files().asset.string()).out;
  CHECK(text.find("refit    moments\n") != std::string::npos);
  CHECK(text.find("\nmoments  ") != std::string::npos);
  CHECK(text.find("\npart ") != std::string::npos);
  CHECK(text.find("\npiece ") != std::string::npos);
  CHECK(text.find("zeta5") != std::string::npos);
}

TEST_CASE("play --json is written frame by frame, and is the text that all of it at once would be") {
  using nlohmann::ordered_json;
  const TemporaryFolder folder;
  const fs::path out = folder.path / "play.json";
  const ordered_json head{{"backend", "simd"}, {"refit", "moments"}};
  ordered_json whole = head;
  // Names of clips are any bytes; lists may be empty, and lists of lists.
  whole["frames"] = {{{"index", 0}, {"pairs", ordered_json::array()}, {"all_pairs", {{"tests", 3}}}},
                     {{"index", 1}, {"pairs", {{1, 2}, {3, 40}}}, {"clip", "a\nb \"c\", \xff {\n}"}},
                     {{"index", 2}, {"time", 0.1}, {"pairs", {{1, 2}}}}};
  const ordered_json tail{{"clips", {{{"name", "walk"}, {"frames", {{1, 2}}}}}}};
  whole.update(tail);
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
  CHECK(!fs::exists(out));
  file.finish(tail);
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
  CHECK(both["backend"] == (spherechain::supported_targets()[0] == SC_TARGET_SCALAR ? "scalar" : "simd"));
  CHECK(both["target"] == sc_target_name(spherechain::supported_targets()[0]));
  CHECK(both["refit"] == "moments");
  CHECK(both["parts"].size() == baked_human().body_parts.parts.size());
  CHECK(both["parts"][0] ==
        json{{"name", "hips"}, {"side", "none"}, {"bone", "pelvis"}, {"triangles", both["parts"][0]["triangles"]}});
  std::size_t triangles = 0;
  for (const json& part : both["parts"]) triangles += part["triangles"].get<std::size_t>();
  CHECK(triangles == baked_human().character.source_triangles.size());
  REQUIRE(both["frames"].size() == 5);
  for (std::size_t i = 0; i < 5; ++i) {
    const json& frame = both["frames"][i];
    CHECK(frame["index"] == i);
    CHECK(frame["clip_frame"] == i);
    CHECK(frame["time"].get<double>() == doctest::Approx(0.1 * static_cast<double>(i)));
    CHECK(frame.contains("refit_us"));
    CHECK(frame["all_pairs"]["pairs"] == frame["pairs"].size());
    CHECK(frame["all_pairs"]["tests"] == both["frames"][0]["all_pairs"]["tests"]);
    CHECK(frame["all_pairs"].contains("us"));
    CHECK(frame["skin"].contains("us"));
    CHECK(std::is_sorted(frame["skin"]["sphere_pairs"].begin(), frame["skin"]["sphere_pairs"].end()));
    CHECK(!frame["skin"].contains("triangles"));
  }
  const json &rest = both["frames"][0], &end = both["frames"][4];
  CHECK(rest["skin"]["sphere_pairs"].empty());
  CHECK(rest["skin"]["parts"].empty());
  CHECK(!end["skin"]["sphere_pairs"].empty());
  CHECK(end["skin"]["sphere_pairs"].size() < end["pairs"].size());
  CHECK(rest["pairs"].empty());
  CHECK(!end["pairs"].empty());

  const Run triangle_run = play(fmt::format("--contacts --poses {} --frames 5 --fps 10", pose("hands_on_hips.json")));
  REQUIRE(triangle_run.code == 0);
  const json listed = json::parse(contents(out));
  const auto& sphere_of = baked_human().binding.sphere_of_triangle;
  std::vector<std::size_t> owner(baked_human().character.source_triangles.size());
  for (std::size_t t = 0; t < sphere_of.size(); ++t)
    owner[baked_human().character.skin_source_triangle[t]] = sphere_of[t];
  CHECK(listed["frames"][0]["skin"]["triangles"].empty());
  std::set<json> spheres;  // whose triangles they are
  std::map<std::pair<std::string, std::string>, std::size_t> parts;
  const auto& body_parts = baked_human().body_parts;
  for (const json& pair : listed["frames"][4]["skin"]["triangles"]) {
    const auto a = pair[0].get<std::size_t>(), b = pair[1].get<std::size_t>();
    spheres.insert(owner.at(a) < owner.at(b) ? json{owner[a], owner[b]} : json{owner[b], owner[a]});
    const auto [first, second] = std::minmax(body_parts.of_triangle.at(a), body_parts.of_triangle.at(b));
    ++parts[{body_parts.parts[first].name, body_parts.parts[second].name}];
  }
  const json& skin = listed["frames"][4]["skin"];
  CHECK(spheres == std::set<json>(skin["sphere_pairs"].begin(), skin["sphere_pairs"].end()));
  REQUIRE(skin["parts"].size() == parts.size());
  for (const json& pair : skin["parts"]) CHECK(parts.at({pair["a"], pair["b"]}) == pair["triangle_pairs"]);

  const Run scalar = play("--radius fit --backend scalar");
  REQUIRE(scalar.code == 0);
  CHECK(scalar.out.find("rest pose: 1 frame at 30 fps. No contact.\n") == 0);
  CHECK(scalar.out.find("\n(radius fit, refit moments, backend scalar)\n") != std::string::npos);
  const json one = json::parse(contents(out));
  CHECK(one["backend"] == "scalar");
  CHECK(one["target"] == "scalar");
  CHECK(one["clips"][0]["contacts"].empty());
}

TEST_CASE("play tells which body parts touch, in which frames, and how the spheres do") {
  const TemporaryFolder folder;
  const fs::path out = folder.path / "play.json";
  const Run play = run(fmt::format("play {} --source {} --json {} --poses {} --frames 20", baked_files().asset.string(),
                                   kHumanFile, out.string(), pose("animation_arms.json")));
  REQUIRE(play.code == 0);
  const json found = json::parse(contents(out)), clip = found["clips"].at(0);
  CHECK(found["clips"].size() == 1);
  CHECK(clip["name"] == "");
  CHECK(clip["frame_count"] == 20);
  CHECK(clip["fps"] == 30);
  REQUIRE(clip["contacts"].size() > 1);
  std::set<int> with_contact;
  const auto is_fault_class = [](const json& of) {
    return of["class"] == "inside" || of["class"] == "penetration" || of["class"] == "deep_fold";
  };
  int faults = 0;
  std::set<int> with_fault;
  for (const json& frame : found["frames"]) {
    for (const json& one : frame["penetrations"]) {
      if (is_fault_class(one)) with_fault.insert(frame["clip_frame"].get<int>());
    }
  }
  for (const json& contact : clip["contacts"]) {
    std::size_t most = 0;
    std::set<int> frames, listed;
    for (const json& frame : found["frames"]) {
      for (const json& pair : frame["skin"]["parts"]) {
        if (pair["a"] != contact["a"] || pair["b"] != contact["b"]) continue;
        frames.insert(frame["clip_frame"].get<int>());
        most = std::max(most, pair["triangle_pairs"].get<std::size_t>());
      }
    }
    for (const json& run : contact["frames"]) {
      for (int i = run[0].get<int>(); i <= run[1].get<int>(); ++i) listed.insert(i);
    }
    CHECK(listed == frames);
    CHECK(contact["triangle_pairs_max"] == most);
    CHECK(frames.count(contact["frame_of_max"].get<int>()) == 1);
    with_contact.insert(frames.begin(), frames.end());
    // Faults have a line of their own.
    const bool is_fault = is_fault_class(contact);
    CHECK(contact["fault_frames"].empty() == !is_fault);
    const std::string line = fmt::format("{:.0f} mm deep at {}, out along (", contact["depth_mm_max"].get<double>(),
                                         contact["frame_of_depth_max"].get<int>());
    CHECK_MESSAGE((play.out.find(line) != std::string::npos) == is_fault, line);
    faults += is_fault ? 1 : 0;
  }
  CHECK(clip["contact_frames"] == with_contact.size());
  CHECK(clip["fault_frames"] == with_fault.size());
  const std::string head =
      fmt::format("motion animation_arms.json: 20 frames at 30 fps; skin contacts in {} frames, faults in {}\n",
                  with_contact.size(), with_fault.size());
  CHECK_MESSAGE(play.out.find(head) == 0, play.out);
  CHECK(faults > 0);
  CHECK(play.out.find("\nspheres: ") != std::string::npos);
  CHECK(play.out.find(" pairs a frame as a cheap alarm; the skin confirms ") != std::string::npos);
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
    for (const char* name : {"pair recall", "\nskin ", "\nspheres, all pairs "})
      CHECK_MESSAGE(done.out.find(name) != std::string::npos, name);
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
  CHECK(found["missed_depth_mm"] == 0);
  CHECK(found["all_pairs"]["missed_depth_mm"] >= 0);
  CHECK(found["all_pairs"]["missed_depth_mm"] < 100);

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
  CHECK(found["reported"] == "skin");
  for (const auto& [key, value] : found["skin"].items()) CHECK(found[key] == value);
  CHECK(found["precision"] == 1);
  CHECK(found["pair_recall"] == 1);
  CHECK(found["reported_per_frame"] < found["all_pairs"]["reported_per_frame"]);
  const json alone = validate("--spheres-alone", cache.string());
  CHECK(alone["reported"] == "all_pairs");
  for (const auto& [key, value] : alone["all_pairs"].items()) CHECK(alone[key] == value);
  for (const char* name : {"skin", "all_pairs"}) CHECK(alone[name] == found[name]);
  const json fit = validate("--radius fit --spheres-alone", cache.string());
  CHECK(fit["truth_pairs"] == found["truth_pairs"]);
  CHECK(fit["radius"] == "fit");
  CHECK(fit["pair_recall"] <= alone["pair_recall"]);
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
