// SPDX-License-Identifier: GPL-3.0-or-later
// Hostile command lines, disks and files: they never cause an internal error.
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <nlohmann/json.hpp>

#include "human.h"
#include "temporary_folder.h"
#include "tool.h"

namespace fs = std::filesystem;

namespace {

using tool::baked_files;
using tool::check_error;
using tool::contents;
using tool::run;

}  // namespace

TEST_CASE("numbers that are none are usage errors" * doctest::test_suite("long runs")) {
  const TemporaryFolder folder;
  for (const char* number : {"--fps nan", "--fps -nan", "--fps inf", "--fps 0", "--fps -1", "--fps 1e7", "--fps ten",
                             "--frames nan", "--frames -1", "--frames 1.5", "--frames 99999999999999999999"}) {
    CAPTURE(number);
    check_error(run(fmt::format("view {} --source {} -o {}/page.html {}", baked_files().asset.string(), kHumanFile,
                                folder.path.string(), number)),
                2, {std::string(number).substr(0, 5)});
  }
  CHECK(tool::files_in(folder.path) == 0);
}

TEST_CASE("a dash is no file to write") {
  for (const char* command :
       {"bake a.glb -o -", "bake a.glb -o a.sphc --report -", "play a.sphc --source a.glb --json -",
        "view a.sphc --source a.glb -o -", "check a.glb -o report --json -"}) {
    check_error(run(command), 2, {"- is standard output elsewhere"});
  }
}

TEST_CASE("an empty name, as of a script's variable that is not set, is a usage error and no option left out") {
  const TemporaryFolder folder;
  const std::string asset = baked_files().asset.string(), out = (folder.path / "out").string(),
                    animated = fmt::format("{} --source {}", asset, kHumanFile);
  for (const char* option : {"--config", "--roles", "--report", "--preview", "--output"}) {
    const std::string output = option == std::string("--output") ? "" : "-o " + out;
    check_error(run(fmt::format("bake {} {} {} ''", kHumanFile, output, option)), 2, {option, "empty"});
  }
  for (const char* option : {"--clip", "--poses", "--motion", "--json"}) {
    check_error(run(fmt::format("play {} {} ''", animated, option)), 2, {option, "empty"});
    check_error(run(fmt::format("validate {} {} ''", animated, option)), 2, {option, "empty"});
  }
  for (const char* option : {"--report", "--validation"})
    check_error(run(fmt::format("view {} -o {} {} ''", animated, out, option)), 2, {option, "empty"});
  check_error(run(fmt::format("bake '' -o {}", out)), 2, {"INPUT", "empty"});
  check_error(run("inspect ''"), 2, {"ASSET", "empty"});
  check_error(run(fmt::format("play '' --source {}", kHumanFile)), 2, {"ASSET", "empty"});
  check_error(run(fmt::format("play {} --source ''", asset)), 2, {"--source", "empty"});
  CHECK(tool::files_in(folder.path) == 0);
}

TEST_CASE("a file's name need not be UTF-8, the JSON about it is" * doctest::test_suite("long runs")) {
  const TemporaryFolder folder;
  const fs::path source = folder.path / "caf\xe9.zae", asset = folder.path / "caf\xe9.sphc";
  fs::copy(kHumanFile, source);
  const fs::path report = folder.path / "report\xe9.json", play = folder.path / "play.json",
                 validation = folder.path / "validation.json";
  const tool::Run bake =
      run(fmt::format("bake {} -o {} --report {}", source.string(), asset.string(), report.string()));
  REQUIRE_MESSAGE(bake.code == 0, bake.error);
  CHECK(nlohmann::json::parse(contents(report))["source"]["file"] == "caf\xef\xbf\xbd.zae");
  for (const auto& [command, file] : {std::pair("play", &play), std::pair("validate", &validation)}) {
    const tool::Run done = run(
        fmt::format("{} {} --source {} --frames 1 --json {}", command, asset.string(), source.string(), file->string()),
        "SPHERECHAIN_CACHE=off");
    CHECK_MESSAGE(done.code == 0, done.error);
    CHECK(nlohmann::json::accept(contents(*file)));
  }
}

TEST_CASE("what a name holds does not reach the console, but as text") {
  const TemporaryFolder folder;
  // A title, a bell, a C1 control, the right to left mark, a line end of Unicode, no UTF-8.
  const std::string hostile = "a\x1b]0;t\x07\r\xc2\x9b\xe2\x80\xae\xe2\x80\xa8\xff\xc0\xafz\xc3\xa9";
  const auto refused = run("inspect '" + hostile + "'");
  check_error(refused, 3,
              {R"(a\u001b]0;t\u0007\u000d\u009b\u202e\u2028\xff\xc0\xafz)"
               "\xc3\xa9"});
  // Two lines of a name are one.
  check_error(run("inspect 'a\nspherechain: b'"), 3, {"a spherechain: b"});

  const std::string name = "a\x1b[31m\xc2\x9b\xe2\x80\xae";
  const std::string gltf =
      R"({"asset":{"version":"2.0"},"nodes":[{"name":)" + nlohmann::json(name).dump() +
      R"(,"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36,"uri":)"
      R"("data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],"bufferViews":[{"buffer":0,)"
      R"("byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],)"
      R"("animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}],"samplers":)"
      R"([{"input":1,"output":0}]}]})";
  nlohmann::json still = nlohmann::json::parse(gltf);
  still["accessors"].push_back({{"componentType", 5126}, {"count", 3}, {"type", "SCALAR"}, {"bufferView", 1}});
  still["bufferViews"].push_back({{"buffer", 1}, {"byteLength", 12}});
  still["buffers"].push_back({{"byteLength", 12}, {"uri", "data:application/octet-stream;base64,AAAAAAAAgD8AAABA"}});
  const std::string file = folder.write("a.gltf", still.dump()).string();
  for (const char* json : {"", " --json"}) {
    const tool::Run roles = run("inspect --roles " + file + json);
    REQUIRE_MESSAGE(roles.code == 0, roles.error);
    for (const char* part : {"\x1b", "\xc2\x9b", "\xe2\x80\xae"}) CHECK(roles.out.find(part) == std::string::npos);
    CHECK(roles.out.find(R"(\u202e)") != std::string::npos);
    if (*json != '\0') CHECK(nlohmann::json::parse(roles.out).dump().find("\xe2\x80\xae") != std::string::npos);
  }
}

TEST_CASE("settings that no settings are end with 3: numbers past the largest, objects without end") {
  const TemporaryFolder folder;
  const auto bake_with = [&](const std::string& text) {
    return run(fmt::format("bake {} -o {}/out.sphc --config {}", kHumanFile, folder.path.string(),
                           folder.write("c.json", text).string()));
  };
  check_error(bake_with(R"({"delta": 1e400})"), 3, {"c.json", "1e400"});
  std::string deep;
  for (int i = 0; i < 300000; ++i) deep += R"({"roles":)";
  check_error(bake_with(deep + "1" + std::string(300000, '}')), 3, {"c.json", "nested"});
  std::string lists = R"({"facing":)" + std::string(300000, '[') + std::string(300000, ']') + "}";
  check_error(bake_with(lists), 3, {"c.json", "nested"});
  CHECK(!fs::exists(folder.path / "out.sphc"));
}

TEST_CASE("devices, pipes and folders are refused at once where a file is needed") {
  const TemporaryFolder folder;
  const std::string pipe = (folder.path / "pipe").string(), list = (folder.path / "pipe.txt").string(),
                    out = (folder.path / "out").string(), asset = baked_files().asset.string();
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  REQUIRE(::mkfifo(list.c_str(), 0600) == 0);
  const auto refused = [&](const std::string& arguments, const std::string& file) {
    CAPTURE(arguments);
    check_error(run(arguments, "timeout 20"), 3, {file + ": is a "});
  };
  for (const std::string& file : {std::string("/dev/zero"), pipe, folder.path.string()}) {
    refused(fmt::format("bake {} -o {}", file, out), file);
    refused(fmt::format("inspect --roles {}", file), file);
    refused(fmt::format("play {} --source {}", asset, file), file);
    if (file == folder.path) continue;
    refused(fmt::format("play {} --source {} --motion {}", asset, kHumanFile, file), file);
    check_error(run(fmt::format("play {} --source {} --poses {}", asset, kHumanFile, file), "timeout 20"), 3, {file});
  }
  refused(fmt::format("play {} --source {} --poses {}", asset, kHumanFile, list), list);
  for (const std::string& file : {std::string("/dev/zero"), folder.path.string()}) {
    refused(fmt::format("bake {} -o {} --config {}", kHumanFile, out, file), file);
    refused(fmt::format("bake {} -o {} --roles {}", kHumanFile, out, file), file);
    refused(fmt::format("inspect {}", file), file);
    refused(fmt::format("play {} --source {}", file, kHumanFile), file);
  }
  CHECK(tool::files_in(folder.path) == 2);
  // Materials are no reason to wait for one.
  const std::string mesh = folder.write("t.obj", "mtllib pipe\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").string();
  check_error(run(fmt::format("play {} --source {}", asset, mesh), "timeout 20"), 3, {"t.obj: is not the mesh"});
}

TEST_CASE("what is read once may come from a pipe") {
  const TemporaryFolder folder;
  const std::string pipe = (folder.path / "pipe").string(), asset = baked_files().asset.string();
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  const tool::Run piped = run(fmt::format("inspect {} & cat {} >{}; wait $!", pipe, asset, pipe), "timeout 20");
  CHECK_MESSAGE(piped.code == 0, piped.error);
  CHECK(piped.out == run("inspect " + asset).out);
}

TEST_CASE("names too long for a file system and folders as outputs end with 3") {
  const std::string name(300, 'x'), asset = baked_files().asset.string();
  check_error(run(fmt::format("bake {}.obj -o out", name)), 3, {name, "too long"});
  check_error(run(fmt::format("bake {} -o {}.sphc", kHumanFile, name)), 3, {name, "too long"});
  check_error(run(fmt::format("inspect {}", name)), 3, {name, "too long"});
  for (const char* option : {"--poses", "--motion"}) {
    check_error(run(fmt::format("play {} --source {} {} {}", asset, kHumanFile, option, name)), 3, {name});
    check_error(run(fmt::format("play {} --source {} {} {}.txt", asset, kHumanFile, option, name)), 3, {name});
  }
  const TemporaryFolder folder;
  check_error(run(fmt::format("bake {} -o {}", kHumanFile, folder.path.string())), 3, {"it is a folder"});
  check_error(run(fmt::format("play {} --source {} --json {}", asset, kHumanFile, folder.path.string())), 3,
              {"it is a folder"});
}

TEST_CASE("what is printed and cannot be written ends with 3" * doctest::test_suite("long runs")) {
  const TemporaryFolder folder;
  check_error(run(fmt::format("inspect {} --json >/dev/full", baked_files().asset.string())), 3, {"standard output"});
  check_error(run(fmt::format("inspect {} >/dev/full", baked_files().asset.string())), 3, {"standard output"});
  check_error(run("--version >/dev/full"), 3, {"standard output"});
  check_error(run(fmt::format("play {} --source {} --frames 1 >/dev/full", baked_files().asset.string(), kHumanFile)),
              3, {"standard output"});
  check_error(run(fmt::format("bake {} -o {}/o.sphc >/dev/full", kHumanFile, folder.path.string())), 3,
              {"standard output"});
}
