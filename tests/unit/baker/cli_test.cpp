// SPDX-License-Identifier: GPL-3.0-or-later
// The command line as pipelines use it: exit codes, one-line errors, JSON, and what is left on disk.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "baked_human.h"
#include "human.h"
#include "play/asset_file.h"
#include "spherechain/simd.h"
#include "temporary_folder.h"
#include "tool.h"

namespace fs = std::filesystem;
using nlohmann::json;
using spherechain::baker::kTorso;

namespace {

using tool::baked_files;
using tool::BakedFiles;
using tool::check_error;
using tool::contents;
using tool::files_in;
using tool::Run;
using tool::run;

std::string pose(const char* name) { return std::string(SPHERECHAIN_SAMPLES) + "/poses/" + name; }

}  // namespace

TEST_CASE("bake writes the same bytes as the library, a report and a table, and no temporary file stays") {
  const BakedFiles& files = baked_files();
  REQUIRE_MESSAGE(files.bake.code == 0, files.bake.error);
  CHECK(files.bake.error.empty());
  CHECK(files.bake.out.find("stage") != std::string::npos);
  const std::string bytes = contents(files.asset);
  CHECK(bytes == std::string(baked_human().asset.begin(), baked_human().asset.end()));
  CHECK(files_in(files.folder.path) == 2);

  const json report = json::parse(contents(files.report));
  CHECK(report["import"]["body_triangles"] == 26756);
  CHECK(report["bind"]["pivots"]["asked"] == 8);
  CHECK(report["bind"]["owner_distance"]["mean"] < 0.01);
  CHECK(report["counts"]["spheres"] == baked_human().spheres.spheres.size());
  CHECK(report["counts"]["why"].get<std::string>().find("touch the skin") != std::string::npos);
  for (const json& sphere : report["fit"]["torso"]) {
    for (const char* fit : {"phi1", "phi1_adjusted", "phi2"})
      CHECK(sphere[fit]["F"].size() == sphere["vertices"].size());
    CHECK(sphere["phi1_adjusted"]["mean_abs_F"] <= sphere["phi1"]["mean_abs_F"]);
  }
  std::set<std::string> stages;
  for (const json& stage : report["stages"]) stages.insert(stage["stage"].get<std::string>());
  CHECK(stages ==
        std::set<std::string>{"import", "roles", "segment", "fit", "chains", "bind", "rig", "leaves", "write"});
}

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

TEST_CASE(
    "play --backend cuda finds M2's pairs on a GPU; where there is none it says so, exits with 1 and writes nothing") {
  const TemporaryFolder folder;
  const fs::path out = folder.path / "play.json";
  const auto play = [&](const std::string& more) {
    return fmt::format("play {} --source {} --poses {} --frames 5 --json {} {}", baked_files().asset.string(),
                       kHumanFile, pose("arms_crossed.json"), out.string(), more);
  };
  check_error(run(play("--backend cuda --mode m1")), 2, {"--backend cuda: has no M1 (--mode m2)"});
  const Run on_gpu = run(play("--backend cuda"));
  if (on_gpu.code != 0) {
    check_error(on_gpu, 1, {"--backend cuda: ", "CUDA", "--backend auto needs no GPU"});
    CHECK(!fs::exists(out));
    return;
  }
  const json cuda = json::parse(contents(out));
  REQUIRE(run(play("--mode m2")).code == 0);
  const json simd = json::parse(contents(out));
  CHECK(cuda["backend"] == "cuda");
  for (std::size_t i = 0; i < 5; ++i) CHECK(cuda["frames"][i]["pairs"] == simd["frames"][i]["pairs"]);
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

TEST_CASE("SPHERECHAIN_TARGET names the instructions to play with; one that is not there is a usage error") {
  const TemporaryFolder folder;
  const fs::path out = folder.path / "play.json";
  const auto play = [&](const char* target, const std::string& more) {
    return run(fmt::format("play {} --source {} --frames 1 --json {} {}", baked_files().asset.string(), kHumanFile,
                           out.string(), more),
               std::string("SPHERECHAIN_TARGET=") + target);
  };
  for (const spherechain::Target target : spherechain::supported_targets()) {
    const Run done = play(spherechain::to_string(target), "--backend simd");
    REQUIRE(done.code == 0);
    CHECK(json::parse(contents(out))["target"] == spherechain::to_string(target));
    CHECK(done.out.find(spherechain::to_string(target)) != std::string::npos);
  }
  REQUIRE(play("best", "").code == 0);
  CHECK(json::parse(contents(out))["target"] == spherechain::to_string(spherechain::best_target()));
  REQUIRE(play("best", "--backend scalar").code == 0);
  CHECK(json::parse(contents(out))["target"] == "scalar");
  fs::remove(out);
  check_error(play("mmx", ""), 2, {"SPHERECHAIN_TARGET: 'mmx' is no target of this machine (it has ", "scalar)"});
  CHECK(!fs::exists(out));
}

TEST_CASE("--extremities puts spheres in head, hands and feet in any profile" * doctest::test_suite("many bakes")) {
  const TemporaryFolder folder;
  const fs::path out = folder.path / "out.sphc";
  REQUIRE(run(fmt::format("bake {} -o {} --profile paper --extremities", kHumanFile, out.string())).code == 0);
  const json asset = json::parse(run(fmt::format("inspect {} --json", out.string())).out);
  CHECK(asset["sphere_count"] == baked_human().spheres.spheres.size());
  CHECK(asset["settings"]["extremities"] == true);
  CHECK(asset["refit"] == "paper");
}

TEST_CASE("inspect --roles prints each node's role and why, --roles FILE overrules it and is part of the settings") {
  const std::string wolf = "/usr/share/assimp/models/X/Testwuson.X";
  const std::string text = run("inspect --roles " + wolf).out;
  CHECK(text.find("quadruped") == 0);
  CHECK(text.find("its name says hindleg") != std::string::npos);
  const json roles = json::parse(run("inspect --json --roles " + wolf).out);
  CHECK(roles["kind"] == "quadruped");
  CHECK(roles["limbs"][0]["name"] == "left_foreleg");
  CHECK(roles["limbs"][0]["nodes"][0] == "ForeLeg_L_01");
  bool found = false;
  for (const json& node : roles["nodes"]) {
    if (node["name"] != "HindLeg_R_02") continue;
    found = true;
    CHECK(node["role"] == "right_knee");
    CHECK(node["limb"] == "right_hindleg");
    CHECK(roles["nodes"][node["parent"].get<int>()]["name"] == "HindLeg_R_01");
  }
  CHECK(found);

  const TemporaryFolder folder;
  const std::string out = (folder.path / "out.sphc").string();
  const auto roles_file = [&](const std::string& content) { return folder.write("roles.json", content).string(); };
  const auto bake_with = [&](const std::string& content) {
    return run(fmt::format("bake {} -o {} --roles {}", wolf, out, roles_file(content)));
  };
  check_error(bake_with(R"({"Neck": "gill"})"), 3, {"roles.json", "gill", "Neck"});
  check_error(bake_with(R"({"Nick": "neck"})"), 3, {"roles.json", "no node 'Nick'"});
  check_error(run(fmt::format("bake {} -o {} --roles /nowhere.json", wolf, out)), 3, {"/nowhere.json"});
  const spherechain::baker::BakeSettings settings =
      spherechain::baker::make_settings("balanced", R"({"roles": {"Neck": "head"}})", "config.json");
  CHECK(settings.roles.role_of.at("Neck") == "head");
  CHECK(to_json(settings).find(R"("roles":{"Neck":"head"})") != std::string::npos);
}

TEST_CASE("--body says what a body with two pairs of limbs is, goes before the settings, and plays" *
          doctest::test_suite("many bakes")) {
  const TemporaryFolder folder;
  const fs::path asset = folder.path / "beast.sphc", config = folder.write("config.json", R"({"body": "biped"})");
  const std::string beast = "/usr/share/assimp/models/X/Testwuson.X";
  REQUIRE(run(fmt::format("bake {} -o {} --body quadruped --config {}", beast, asset.string(), config.string())).code ==
          0);
  const json inspected = json::parse(run(fmt::format("inspect {} --json", asset.string())).out);
  CHECK(inspected["regions"][0]["name"] == "left_foreleg");
  CHECK(inspected["regions"][4]["name"] == "tail");
  const Run play = run(fmt::format("play {} --source {}", asset.string(), beast));
  CHECK_MESSAGE(play.code == 0, play.error);
  check_error(run(fmt::format("play {} --source {} --poses {}", asset.string(), beast, pose("arms_crossed.json"))), 3,
              {"arms_crossed.json: turns the joints of a biped, and ", "beast.sphc has none"});
  REQUIRE(run(fmt::format("bake {} -o {} --config {}", beast, asset.string(), config.string())).code == 0);
  CHECK(json::parse(run(fmt::format("inspect {} --json", asset.string())).out)["regions"][0]["name"] == "left_arm");
  CHECK(run(fmt::format("bake {} -o {} --body centaur", beast, asset.string())).code == 2);
  check_error(run(fmt::format("bake {} -o {} --config {}", beast, asset.string(),
                              folder.write("wrong.json", R"({"body": "centaur"})").string())),
              3, {"wrong.json", "body", "quadruped"});
}

TEST_CASE("usage errors end with 2") {
  check_error(run(""), 2, {"--help"});
  check_error(run("bake"), 2, {});
  check_error(run("frobnicate"), 2, {"'frobnicate'"});
  check_error(run("--frobnicate"), 2, {"'--frobnicate'"});
  check_error(run("frobnicate bake"), 2, {"'frobnicate'"});
  check_error(run("bake in out"), 2, {});
  check_error(run(fmt::format("bake {} -o x.sphc --profile fancy", kHumanFile)), 2, {"fancy"});
  check_error(run(fmt::format("play {} --source {} --mode m3", baked_files().asset.string(), kHumanFile)), 2, {"m3"});
  check_error(run(fmt::format("validate {} --source {} --mode both", baked_files().asset.string(), kHumanFile)), 2,
              {"both"});
  check_error(run(fmt::format("play {} --source {} --frames 0", baked_files().asset.string(), kHumanFile)), 2, {});
  CHECK(run("--help").code == 0);
  CHECK(run("bake --help").out.find("--report") != std::string::npos);
  CHECK(run("--version").out.find("spherechain ") == 0);
  CHECK(run("--version").out.find(spherechain::to_string(spherechain::best_target())) != std::string::npos);
}

TEST_CASE("files that cannot be read end with 3, name the file and the cause, and leave nothing behind") {
  const TemporaryFolder folder;
  const std::string out = (folder.path / "out.sphc").string();
  const auto junk = folder.write("junk.obj", "hello").string(), empty = folder.write("empty.sphc", "").string();
  const std::size_t before = files_in(folder.path);
  check_error(run("bake /nowhere.obj -o " + out), 3, {"/nowhere.obj", "no such file"});
  check_error(run("bake " + junk + " -o " + out), 3, {"junk.obj"});
  check_error(run(fmt::format("bake {} -o {} --config /nowhere.json", kHumanFile, out)), 3, {"/nowhere.json"});
  check_error(run("inspect /nowhere.sphc"), 3, {"/nowhere.sphc", "no such file"});
  check_error(run("inspect " + empty), 3, {"empty.sphc"});
  check_error(run("inspect " + junk), 3, {"junk.obj"});
  check_error(run(fmt::format("play {} --source {}", baked_files().asset.string(), junk)), 3, {"junk.obj"});
  check_error(run(fmt::format("play {} --source {} --poses {}", baked_files().asset.string(), kHumanFile, junk)), 3,
              {"junk.obj"});
  check_error(run(fmt::format("validate {} --source {}", baked_files().asset.string(), junk)), 3, {"junk.obj"});
  CHECK(files_in(folder.path) == before);
  check_error(run(fmt::format("validate {} --source {} --frames 1 --json /nowhere/out.json",
                              baked_files().asset.string(), kHumanFile)),
              3, {"/nowhere/out.json"});
  check_error(run(fmt::format("bake {} -o /nowhere/out.sphc", kHumanFile)), 3, {"/nowhere/out.sphc"});
}

TEST_CASE("broken settings end with 3 and name the setting") {
  const TemporaryFolder folder;
  const auto bake_with = [&](const std::string& text) {
    return run(fmt::format("bake {} -o {} --config {}", kHumanFile, (folder.path / "out.sphc").string(),
                           folder.write("c.json", text).string()));
  };
  check_error(bake_with("{"), 3, {"c.json", "JSON"});
  check_error(bake_with("[1]"), 3, {"c.json", "object"});
  check_error(bake_with(R"({"rayz": 80})"), 3, {"c.json", "rayz", "unknown"});
  check_error(bake_with(R"({"rays": 3})"), 3, {"rays", "8"});
  check_error(bake_with(R"({"penetration_depth": "much"})"), 3, {"penetration_depth"});
  check_error(bake_with(R"({"extremities": 1})"), 3, {"extremities", "true"});
  check_error(bake_with(R"({"spheres_per_level": 4})"), 3, {"spheres_per_level", "3"});
  check_error(bake_with(R"({"pivots": 3})"), 3, {"pivots", "4"});
  check_error(bake_with(R"({"refit": "paper", "pivots": 1})"), 3, {"pivots", "2"});
  check_error(bake_with(R"({"facing": [0, 0, 0]})"), 3, {"facing"});
  check_error(bake_with(R"({"targets": {"speed": 1}})"), 3, {"speed"});
  CHECK(!fs::exists(folder.path / "out.sphc"));
}

TEST_CASE("a profile is where the settings start; the number of pivots follows the refit rule") {
  using spherechain::baker::make_settings;
  const auto balanced = make_settings("balanced", "{}", ""), paper = make_settings("paper", "{}", ""),
             mixed = make_settings("balanced", R"({"refit": "paper", "spheres_per_level": 3})", ""),
             many = make_settings("paper", R"({"extremities": true, "pivots": 16})", "");
  CHECK(balanced.fit.extremities);
  CHECK(balanced.bind.pivots == 8);
  CHECK(!paper.fit.extremities);
  CHECK(paper.bind.pivots == 4);
  CHECK(mixed.bind.pivots == 4);
  CHECK(mixed.fit.spheres_per_level == 3);
  CHECK(many.fit.extremities);
  CHECK(many.bind.pivots == 16);
}

TEST_CASE("a mesh that cannot be segmented ends with 4") {
  const TemporaryFolder folder;
  // A tetrahedron has no limbs.
  const auto mesh =
      folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n").string();
  check_error(run(fmt::format("bake {} -o {}", mesh, (folder.path / "t.sphc").string())), 4, {"t.obj", "missing"});
  CHECK(!fs::exists(folder.path / "t.sphc"));
}

TEST_CASE("a missed target ends with 5, says so, and writes the asset all the same" *
          doctest::test_suite("many bakes")) {
  const TemporaryFolder folder;
  const auto config = folder.write("c.json", R"({"targets": {"max_spheres": 10, "min_covered_area": 0.01}})").string();
  const fs::path out = folder.path / "out.sphc", report = folder.path / "r.json";
  const Run result =
      run(fmt::format("bake {} -o {} --config {} --report {}", kHumanFile, out.string(), config, report.string()));
  CHECK(result.code == 5);
  CHECK(result.error.find("max_spheres: 10 asked") != std::string::npos);
  CHECK(fs::exists(out));
  CHECK(json::parse(contents(report))["missed_targets"].size() == 1);
}

TEST_CASE("an output that is no asset is not overwritten without --force, nor is the input with it") {
  const TemporaryFolder folder;
  const auto precious = folder.write("thesis.txt", "years of work").string();
  check_error(run(fmt::format("bake {} -o {}", kHumanFile, precious)), 3, {"thesis.txt", "--force"});
  CHECK(contents(precious) == "years of work");
  const auto glb = (folder.path / "p.glb").string();
  check_error(run(fmt::format("bake {} -o {} --preview {}", kHumanFile, glb + ".sphc", precious)), 3,
              {"thesis.txt", "not a GLB file", "--force"});
  check_error(run(fmt::format("bake {} -o {} --preview {} --force", kHumanFile, glb, glb)), 2, {"p.glb", "same file"});
  check_error(run(fmt::format("bake {} -o {} --preview /nowhere/p.glb", kHumanFile, glb)), 3, {"/nowhere"});
  CHECK(contents(precious) == "years of work");
  CHECK(files_in(folder.path) == 1);
  const auto input = folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").string();
  check_error(run(fmt::format("bake {} -o {} --force", input, input)), 2, {"same file"});
  CHECK(contents(input).rfind("v 0 0 0", 0) == 0);
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

TEST_CASE("contacts of triangles are asked of an asset that has leaves") {
  const std::string golden = SPHERECHAIN_SAMPLES "/../tests/golden/";  // this asset is older than leaves
  for (const char* command : {"play", "validate"}) {
    check_error(run(fmt::format("{} {}doll.sphc --source {}doll.obj --frames 1 --contacts", command, golden, golden)),
                3, {"doll.sphc", "has no leaves", "bake it again"});
  }
}

TEST_CASE("an asset is refused for another mesh than its source") {
  const TemporaryFolder folder;
  const auto other =
      folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n").string();
  check_error(run(fmt::format("play {} --source {}", baked_files().asset.string(), other)), 3,
              {"t.obj", "not the mesh"});
}
