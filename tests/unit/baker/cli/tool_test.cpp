// SPDX-License-Identifier: GPL-3.0-or-later
// The command line as pipelines use it: exit codes, one-line errors, and what is left on disk.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <set>

#include "baked_human.h"
#include "baker/report/report.h"
#include "human.h"
#include "runtime/src/simd/simd.h"
#include "temporary_folder.h"
#include "tool.h"

namespace fs = std::filesystem;
using nlohmann::json;

namespace {

using tool::baked_files;
using tool::BakedFiles;
using tool::check_error;
using tool::contents;
using tool::files_in;
using tool::last_line;
using tool::pose;
using tool::Run;
using tool::run;

}  // namespace

TEST_CASE("bake writes the same bytes as the library, a report and a table, and no temporary file stays") {
  const BakedFiles& files = baked_files();
  REQUIRE_MESSAGE(files.bake.code == 0, files.bake.error);
  CHECK(files.bake.error.empty());
  CHECK(files.bake.out.find("stage") != std::string::npos);
  CHECK(last_line(files.bake.out) == "fit: good");
  const std::string bytes = contents(files.asset);
  CHECK(bytes == std::string(baked_human().asset.begin(), baked_human().asset.end()));
  CHECK(files_in(files.folder.path) == 2);

  const json report = json::parse(contents(files.report));
  CHECK(report["import"]["body_triangles"] == 26756);
  CHECK(report["bind"]["pivots"]["asked"] == 8);
  CHECK(report["bind"]["quality"]["distance_mean"] < 0.01);
  CHECK(report["counts"]["spheres"] == baked_human().spheres.spheres.size());
  CHECK(report["counts"]["why"].get<std::string>().find("touch the skin") != std::string::npos);
  for (const json& sphere : report["fit"]["torso"]) {
    for (const char* fit : {"phi1", "phi1_adjusted", "phi2"})
      CHECK(sphere[fit]["F"].size() == sphere["vertices"].size());
    CHECK(sphere["phi1_adjusted"]["mean_abs_F"] <= sphere["phi1"]["mean_abs_F"]);
  }
  std::set<std::string> stages;
  for (const json& stage : report["stages"]) stages.insert(stage["stage"].get<std::string>());
  CHECK(stages == std::set<std::string>{"import", "roles", "fit", "chains", "bind", "rig", "clusters", "layers",
                                        "write", "calibrate"});
}

TEST_CASE(
    "play --backend cuda finds the pairs on a GPU; where there is none it says so, exits with 1 and writes nothing") {
  const TemporaryFolder folder;
  const fs::path out = folder.path / "play.json";
  const auto play = [&](const std::string& more) {
    return fmt::format("play {} --source {} --poses {} --frames 5 --json {} {}", baked_files().asset.string(),
                       kHumanFile, pose("arms_crossed.json"), out.string(), more);
  };
  const Run on_gpu = run(play("--backend cuda"));
  if (on_gpu.code != 0) {
    check_error(on_gpu, 1, {"--backend cuda: ", "CUDA", "--backend auto needs no GPU"});
    CHECK(!fs::exists(out));
    return;
  }
  const json cuda = json::parse(contents(out));
  REQUIRE(run(play("")).code == 0);
  const json simd = json::parse(contents(out));
  CHECK(cuda["backend"] == "cuda");
  for (std::size_t i = 0; i < 5; ++i) CHECK(cuda["frames"][i]["pairs"] == simd["frames"][i]["pairs"]);
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
    const Run done = play(sc_target_name(target), "--backend simd");
    REQUIRE(done.code == 0);
    CHECK(json::parse(contents(out))["target"] == sc_target_name(target));
    CHECK(done.out.find(sc_target_name(target)) != std::string::npos);
  }
  REQUIRE(play("best", "").code == 0);
  CHECK(json::parse(contents(out))["target"] == sc_target_name(spherechain::supported_targets()[0]));
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
  check_error(
      run(fmt::format("play {} --source {} --poses {}", asset.string(), beast, pose("arms_crossed.json"))), 3,
      {"arms_crossed.json: turns the joints of the automatic rig, and ", "beast.sphc moves with", "\"rig\": \"own\""});
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
  check_error(run(fmt::format("play {} --source {} --radius m1", baked_files().asset.string(), kHumanFile)), 2, {"m1"});
  check_error(run(fmt::format("play {} --source {} --frames 0", baked_files().asset.string(), kHumanFile)), 2, {});
  CHECK(run("--help").code == 0);
  CHECK(run("bake --help").out.find("--report") != std::string::npos);
  CHECK(run("--version").out.find("spherechain ") == 0);
  CHECK(run("--version").out.find(sc_target_name(spherechain::supported_targets()[0])) != std::string::npos);
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

TEST_CASE("a mesh without the body that it is said to have ends with 4; as it is, it bakes") {
  const TemporaryFolder folder;
  // A tetrahedron has no limbs.
  const auto mesh =
      folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n").string();
  const std::string bake = fmt::format("bake {} -o {}", mesh, (folder.path / "t.sphc").string());
  check_error(run(bake + " --body biped"), 4, {"t.obj", "missing"});
  CHECK(!fs::exists(folder.path / "t.sphc"));
  const Run baked = run(bake);
  CHECK(baked.code == 0);
  CHECK(last_line(baked.out).rfind("fit: ", 0) == 0);
  CHECK(last_line(baked.out).find("; all parts by the generic fit") != std::string::npos);
}

TEST_CASE("the grade names the parts by the generic fit, or says that all are, or nothing") {
  using spherechain::baker::generic_fit_text;
  CHECK(generic_fit_text({}, 5) == "");
  CHECK(generic_fit_text({"horn"}, 5) == "; 1 part by the generic fit: horn");
  CHECK(generic_fit_text({"skirt", "horn"}, 5) == "; 2 parts by the generic fit: skirt, horn");
  CHECK(generic_fit_text({"a", "b"}, 2) == "; all parts by the generic fit");
  CHECK(generic_fit_text({"a", "b", "c", "d", "e", "f", "g"}, 9) == "; 7 of 9 parts by the generic fit");
}

TEST_CASE("a bake comes to its end where a hand or foot is folded to nothing in between" *
          doctest::test_suite("many bakes")) {
  const TemporaryFolder folder;
  const Run baked = run(
      fmt::format("bake {} -o {}/out.sphc", (kModels / "BLEND/MirroredCube_252.blend").string(), folder.path.string()),
      "timeout 200");
  CHECK_MESSAGE(baked.code == 0, baked.error);
}

TEST_CASE("a missed target ends with 5, says so, and writes the asset all the same" *
          doctest::test_suite("many bakes")) {
  const TemporaryFolder folder;
  const auto config = folder.write("c.json", R"({"spheres": 10, "targets": {"fit": "good"}})").string();
  const fs::path out = folder.path / "out.sphc", report = folder.path / "r.json";
  const Run result =
      run(fmt::format("bake {} -o {} --config {} --report {}", kHumanFile, out.string(), config, report.string()));
  CHECK(result.code == 5);
  CHECK(result.error.find("spheres: 10 asked") != std::string::npos);
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

TEST_CASE("an asset is refused for another mesh than its source") {
  const TemporaryFolder folder;
  const auto other =
      folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n").string();
  check_error(run(fmt::format("play {} --source {}", baked_files().asset.string(), other)), 3,
              {"t.obj", "not the mesh"});
}
