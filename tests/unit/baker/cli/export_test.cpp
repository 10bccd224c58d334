// SPDX-License-Identifier: GPL-3.0-or-later
// `spherechain export` as a command: what it refuses, and that nothing is written then.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "human.h"
#include "temporary_folder.h"
#include "tool.h"

using nlohmann::json;

namespace {

std::string export_of(const std::filesystem::path& output, const std::string& words) {
  return fmt::format("export {} {} -o {}", tool::baked_files().asset.string(), words, output.string());
}

}  // namespace

TEST_CASE("export: the JSON has the human's parts, each after the one it hangs on, and as many volumes as asked for" *
          doctest::test_suite("many bakes")) {
  const TemporaryFolder folder;
  const tool::Run run = tool::run(export_of(folder.path / "human.json", "--to capsules.json --at-most 9"));
  REQUIRE_MESSAGE(run.code == 0, run.error);
  CHECK(run.out.starts_with("9 volumes (cones) on 9 body parts; "));
  const json out = json::parse(tool::contents(folder.path / "human.json"));
  std::size_t volumes = 0, held = 0;
  std::vector<json> seen{nullptr};
  for (const json& body : out["bodies"]) {
    CHECK(std::find(seen.begin(), seen.end(), body["parent"]) != seen.end());
    seen.push_back(body["part"]);
    volumes += body["volumes"].size();
    held += body.contains("held_by") ? 1 : 0;
    CHECK((body["volumes"].empty() || !body.contains("held_by")));
  }
  CHECK(volumes == 9);
  CHECK(held == out["bodies"].size() - 9);
  CHECK(out["height"].get<double>() == doctest::Approx(1.7).epsilon(0.1));
}

TEST_CASE("export: what is wrong is said before anything is written" * doctest::test_suite("many bakes")) {
  const TemporaryFolder folder;
  const auto refused = [&](const std::string& words, int code, const std::vector<std::string>& parts,
                           const std::string& name = "human.xml") {
    tool::check_error(tool::run(export_of(folder.path / name, words)), code, parts);
    CHECK(tool::files_in(folder.path) == 0);
  };
  refused("--to vrm", 2, {"--source"});
  refused("--to mjcf --source /usr/share/assimp/models/OBJ/spider.obj", 3, {"spider.obj"});
  refused("--to mjcf --filter nowhere.json", 3, {"nowhere.json"});
  refused("--to mjcf --at-most 0", 2, {"--at-most"});
  refused(std::string("--to khr --source ") + kHumanFile, 3, {"bones"}, "human.glb");  // it has none of its own
  const std::string view =
      fmt::format("view {} --source {} --filter nowhere.json -o {} ", tool::baked_files().asset.string(), kHumanFile,
                  (folder.path / "human.html").string());
  tool::check_error(tool::run(view + "--volumes cones"), 3, {"nowhere.json"});
  tool::check_error(tool::run(view), 2, {"--volumes"});
  refused("--to usd", 2, {"human.usdc", ".usda or .usd"}, "human.usdc");
}

TEST_CASE("export: a file of somebody else stays, also beside the output, but by force" *
          doctest::test_suite("many bakes")) {
  const TemporaryFolder folder;
  const std::filesystem::path beside = folder.write("human.srdf", "somebody's");
  const std::string words = export_of(folder.path / "human.urdf", "--to urdf");
  tool::check_error(tool::run(words), 3, {"human.srdf", "--force"});
  CHECK(tool::files_in(folder.path) == 1);
  CHECK(tool::contents(beside) == "somebody's");
  CHECK(tool::run(words + " --force").code == 0);
  CHECK(tool::contents(beside) != "somebody's");
  CHECK(tool::run(words).code == 0);  // of its own making
  // A GLB is of this tool if it has its mark.
  const std::filesystem::path glb = folder.write("human.glb", R"(glTF {"nodes":[{"name":"spherechain\u0020"}]})");
  const std::string into = export_of(glb, std::string("--to khr --source ") + kHumanFile);
  tool::check_error(tool::run(into), 3, {"human.glb", "--force"});
  const std::string own = R"({"asset":{"version":"2.0","extras":{"spherechain":"0"}}} )";
  const char size[] = {static_cast<char>(own.size()), 0, 0, 0};
  folder.write("human.glb", "glTF" + std::string(8, ' ') + std::string(size, 4) + "JSON" + own);
  tool::check_error(tool::run(into), 3, {"bones"});  // it would have been replaced
}
