// SPDX-License-Identifier: GPL-3.0-or-later
// Files that the command line replaces, and files that it does not.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <filesystem>

#include "human.h"
#include "temporary_folder.h"
#include "tool.h"

namespace fs = std::filesystem;

namespace {

using tool::baked_files;
using tool::check_error;
using tool::contents;
using tool::files_in;
using tool::run;

// A command must end with 2, name both options, and leave all files of the folder as they are.
void check_refused(const fs::path& folder, const std::string& arguments, const char* input, const char* output) {
  CAPTURE(arguments);
  std::vector<std::pair<fs::path, std::string>> before;
  for (const fs::directory_entry& file : fs::directory_iterator(folder)) {
    if (file.is_regular_file()) before.emplace_back(file.path(), contents(file.path()));
  }
  const std::size_t count = files_in(folder);
  check_error(run(arguments), 2, {std::string(input) + " and " + output + " are the same file"});
  for (const auto& [path, bytes] : before) CHECK(contents(path) == bytes);
  CHECK(files_in(folder) == count);
}

// Nothing in it matters: what is refused for its name is refused before it is read.
std::string touch(const TemporaryFolder& folder, const char* name) { return folder.write(name, "precious").string(); }

}  // namespace

TEST_CASE("no command writes over what it reads, with --force neither") {
  const TemporaryFolder folder;
  const std::string source = touch(folder, "human.glb"), asset = touch(folder, "human.sphc"),
                    poses = touch(folder, "poses.json"), motion = touch(folder, "motion.bvh"),
                    report = folder.write("report.json", "{}").string(),
                    validation = folder.write("validation.json", "{}").string(),
                    settings = folder.write("settings.json", "{}").string(), page = touch(folder, "page.html");
  const auto refused = [&](const std::string& arguments, const char* input, const char* output) {
    check_refused(folder.path, arguments, input, output);
  };
  const std::string bake = fmt::format("bake {} --force -o ", source), out = (folder.path / "out").string();
  refused(bake + source, "INPUT", "-o");
  refused(fmt::format("{}{} --report {}", bake, out, source), "INPUT", "--report");
  refused(fmt::format("{}{} --preview {}", bake, out, source), "INPUT", "--preview");
  for (const char* option : {"--config", "--roles"}) {
    for (const char* output : {"--report", "--preview"}) {
      refused(fmt::format("{}{} {} {} {} {}", bake, out, option, settings, output, settings), option, output);
    }
    refused(fmt::format("{}{} {} {}", bake, settings, option, settings), option, "-o");
  }
  refused(fmt::format("{}{} --report {}", bake, out, out), "-o", "--report");

  for (const char* command : {"play", "validate"}) {
    const std::string start = fmt::format("{} {} --source {} --json ", command, asset, source);
    refused(start + asset, "ASSET", "--json");
    refused(start + source, "--source", "--json");
    refused(fmt::format("{}{} --poses {}", start, poses, poses), "--poses", "--json");
    refused(fmt::format("{}{} --motion {}", start, motion, motion), "--motion", "--json");
  }

  const std::string view = fmt::format("view {} --source {} --force -o ", asset, source);
  refused(view + asset, "ASSET", "-o");
  refused(view + source, "--source", "-o");
  refused(fmt::format("{}{} --report {}", view, report, report), "--report", "-o");
  refused(fmt::format("{}{} --validation {}", view, validation, validation), "--validation", "-o");
  refused(fmt::format("{}{} --poses {}", view, poses, poses), "--poses", "-o");
}

TEST_CASE("no command writes over a mesh of the sequence it plays, listed or in a folder") {
  const TemporaryFolder folder;
  fs::create_directory(folder.path / "frames");
  const std::string mesh = folder.write("frames/1.obj", "precious").string();
  const std::string list = folder.write("list.txt", "frames/1.obj\n").string();
  for (const std::string& motion : {fmt::format("--motion {}/frames", folder.path.string()), "--poses " + list}) {
    check_refused(folder.path / "frames", fmt::format("play a.sphc --source a.glb --json {} {}", mesh, motion),
                  motion.rfind("--motion", 0) == 0 ? "--motion" : "--poses", "--json");
  }
}

TEST_CASE("no command writes over what its inputs are made of: a glTF's buffers and pictures, poses of other files") {
  const TemporaryFolder folder;
  const std::string gltf =
      folder
          .write("body.gltf", R"({"asset": {"version": "2.0"}, "images": [{"uri": "skin%20one.png"}, {"uri": 3}, 4],
                     "buffers": [{"byteLength": 8, "uri": "body.bin"}, {"byteLength": 1, "uri": "data:;base64,AA=="}]})")
          .string();
  touch(folder, "body.bin");
  touch(folder, "skin one.png");
  const std::string poses = folder.write("poses.json", R"({"poses": ["more.json"]})").string();
  folder.write("more.json", R"({"poses": ["most.json", "more.json", "none.json", {}]})");
  touch(folder, "most.json");
  folder.write("list.txt", "body.gltf\n");
  const auto refused = [&](const std::string& arguments, const char* file, const char* input, const char* output) {
    check_refused(folder.path, fmt::format("{} '{}/{}'", arguments, folder.path.string(), file), input, output);
  };
  for (const char* file : {"body.bin", "skin one.png"}) {
    refused(fmt::format("bake {} --force -o", gltf), file, "INPUT", "-o");
    refused(fmt::format("bake {} --force -o out --preview", gltf), file, "INPUT", "--preview");
    for (const char* command : {"play", "validate"}) {
      refused(fmt::format("{} a.sphc --source {} --json", command, gltf), file, "--source", "--json");
      refused(fmt::format("{} a.sphc --source a.obj --motion {} --json", command, gltf), file, "--motion", "--json");
      refused(fmt::format("{} a.sphc --source a.obj --poses {}/list.txt --json", command, folder.path.string()), file,
              "--poses", "--json");
    }
    refused(fmt::format("view a.sphc --source {} --force -o", gltf), file, "--source", "-o");
  }
  for (const char* file : {"more.json", "most.json"}) {
    refused(fmt::format("play a.sphc --source a.obj --poses {} --json", poses), file, "--poses", "--json");
    refused(fmt::format("view a.sphc --source a.obj --poses {} --force -o", poses), file, "--poses", "-o");
  }
}

TEST_CASE("no command writes over the materials of an OBJ: named with blanks, several in a line, or as the OBJ is") {
  const TemporaryFolder folder;
  const std::string obj = folder
                              .write("body.OBJ",
                                     "# mtllib not.mtl\nv 0 0 0\r\n\tmtllib  my body.mtl \r\n"
                                     "mtllib\tone.mtl two.mtl\nmtllibrary none.mtl\nmtllib")
                              .string();
  fs::create_directory(folder.path / "frames");
  folder.write("frames/1.obj", "mtllib one.mtl\n");
  touch(folder, "frames/one.mtl");
  const std::string at = folder.path.string();
  for (const char* file : {"my body.mtl", "one.mtl", "two.mtl", "body.mtl"}) {
    touch(folder, file);
    const std::string material = fmt::format("'{}/{}'", at, file);
    check_refused(folder.path, fmt::format("bake {} --force -o {}", obj, material), "INPUT", "-o");
    check_refused(folder.path, fmt::format("bake {} --force -o out --report {}", obj, material), "INPUT", "--report");
    check_refused(folder.path, fmt::format("view a.sphc --source {} --force -o {}", obj, material), "--source", "-o");
  }
  check_refused(folder.path,
                fmt::format("play a.sphc --source a.glb --motion {0}/frames --json {0}/frames/one.mtl", at), "--motion",
                "--json");
  // The comment and the other word name nothing: this is refused for what is in the file.
  for (const char* file : {"not.mtl", "none.mtl"}) {
    touch(folder, file);
    check_error(run(fmt::format("bake {} -o {}/{}", obj, at, file)), 3, {"exists and is not an asset"});
  }
}

TEST_CASE("no command writes over what a mesh of any format is read with, nor over the pictures of its materials") {
  const TemporaryFolder folder;
  fs::create_directory(folder.path / "art");
  const std::string at = folder.path.string();
  // Ogre's mesh names its skeleton and a material, and the material's file, which is found by that name, a picture.
  folder.write("ogre.mesh.xml", R"(<mesh><submeshes><submesh material="Cloth" usesharedvertices="false"
      use32bitindexes="false" operationtype="triangle_list"><faces count="1"><face v1="0" v2="1" v3="2"/></faces>
      <geometry vertexcount="3"><vertexbuffer positions="true"><vertex><position x="0" y="0" z="0"/></vertex><vertex>
      <position x="1" y="0" z="0"/></vertex><vertex><position x="0" y="1" z="0"/></vertex></vertexbuffer></geometry>
      </submesh></submeshes><skeletonlink name="joints.skeleton"/></mesh>)");
  folder.write("joints.skeleton.xml", "<skeleton><bones/></skeleton>");
  folder.write("Cloth.material",
               "material Cloth\n{\ntechnique\n{\npass\n{\ntexture_unit\n{\ntexture cloth.png\n}\n}\n}\n}\n");
  // Doom 3's mesh does not name its animation: it has the mesh's name.
  folder.write("doom.md5mesh", "MD5Version 10\n");
  folder.write("list.txt", "doom.md5mesh\n");
  // X and OBJ name pictures as a disk of Windows has them, which is not this one.
  folder.write("direct.x", R"(xof 0303txt 0032
      Mesh { 3; 0;0;0;, 1;0;0;, 0;1;0;; 1; 3;0,1,2;; MeshMaterialList { 1; 1; 0;;
      Material { 1;1;1;1;; 0; 0;0;0;; 0;0;0;; TextureFilename { "C:\\art\\far.png"; } } } })");
  folder.write("wavefront.obj", "mtllib wavefront.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl c\nf 1 2 3\n");
  folder.write("wavefront.mtl", "newmtl c\nmap_Kd art\\near.png\n");
  for (const char* file : {"cloth.png", "doom.md5anim", "far.png", "art/near.png", "there"}) touch(folder, file);

  for (const auto& [mesh, file] : {std::pair("ogre.mesh.xml", "joints.skeleton.xml"),
                                   {"ogre.mesh.xml", "Cloth.material"},
                                   {"ogre.mesh.xml", "cloth.png"},
                                   {"doom.md5mesh", "doom.md5anim"},
                                   {"direct.x", "far.png"},
                                   {"wavefront.obj", "art/near.png"}}) {
    const auto refused = [&](const std::string& arguments, const char* input, const char* output) {
      check_refused(folder.path, fmt::format("{} {}/{}", arguments, at, file), input, output);
    };
    const std::string input = fmt::format("{}/{}", at, mesh);
    refused(fmt::format("bake {} --force -o", input), "INPUT", "-o");
    refused(fmt::format("bake {} --force -o out --preview {}/there --report", input, at), "INPUT", "--report");
    refused(fmt::format("bake {} --force -o out --preview", input), "INPUT", "--preview");
    refused(fmt::format("play a.sphc --source {} --json", input), "--source", "--json");
    refused(fmt::format("validate a.sphc --source a.glb --motion {} --json", input), "--motion", "--json");
    refused(fmt::format("view a.sphc --source {} --force -o", input), "--source", "-o");
  }
  check_refused(folder.path, fmt::format("play a.sphc --source a.glb --poses {0}/list.txt --json {0}/doom.md5anim", at),
                "--poses", "--json");
  folder.write("doom.md5anim", "");
  check_refused(folder.path, fmt::format("bake {0}/doom.md5mesh -o {0}/doom.md5anim", at), "INPUT", "-o");
  // A file that none of them is read with is refused for what is in it.
  touch(folder, "other.png");
  check_error(run(fmt::format("bake {0}/wavefront.obj -o {0}/other.png", at)), 3, {"exists and is not an asset"});
}

TEST_CASE("what goes to /dev/stdout goes to where that leads, and takes the name from nobody") {
  const std::string play =
      fmt::format("play {} --source {} --frames 1 --json ", baked_files().asset.string(), kHumanFile);
  // By the name in /proc: there a tool that replaced it could do no harm.
  REQUIRE(fs::is_symlink("/proc/self/fd/1"));
  const tool::Run to_file = run(play + "/proc/self/fd/1");  // tool::run sends the output to a file
  CHECK_MESSAGE(to_file.code == 0, to_file.error);
  CHECK(to_file.out.rfind("{\n \"writer\": ", 0) == 0);
  CHECK(to_file.out.find("\n}\nrest pose: 1 frame") != std::string::npos);
  const tool::Run to_pipe = run(play + "/proc/self/fd/1 | cat");
  CHECK(to_pipe.out.find("\n}\nrest pose: 1 frame") != std::string::npos);
  const TemporaryFolder folder;
  fs::create_symlink("/proc/self/fd/1", folder.path / "link");
  const tool::Run by_link = run(fmt::format("{}{}/link", play, folder.path.string()));
  CHECK(by_link.out.rfind("{\n \"writer\": ", 0) == 0);
  CHECK(by_link.out.find("\n}\nrest pose: 1 frame") != std::string::npos);
  const std::string third = (folder.path / "third").string();
  CHECK(run(fmt::format("{}/dev/fd/3 3>{}", play, third)).code == 0);
  CHECK(contents(third).rfind("{\n \"writer\": ", 0) == 0);
  CHECK(files_in(folder.path) == 2);
}

TEST_CASE("two names of one file are seen to be one: links, and files that are not there yet") {
  const TemporaryFolder folder;
  const std::string source = touch(folder, "human.glb");
  fs::create_symlink("human.glb", folder.path / "link.glb");
  fs::create_hard_link(source, folder.path / "hard.glb");
  for (const char* link : {"link.glb", "hard.glb"}) {
    check_refused(folder.path, fmt::format("play a.sphc --source {} --json {}/{}", source, folder.path.string(), link),
                  "--source", "--json");
  }
  const fs::path here = fs::current_path();
  fs::current_path(folder.path);
  for (const char* report : {"./new.x", "new.x", "sub/../new.x", "../{}/new.x"}) {
    const std::string path = fmt::format(fmt::runtime(report), folder.path.filename().string());
    if (path.rfind("sub", 0) == 0) fs::create_directory("sub");
    check_refused(folder.path, fmt::format("bake human.glb -o new.x --report {}", path), "-o", "--report");
    check_refused(folder.path, fmt::format("bake human.glb -o {}/new.x --preview {}", folder.path.string(), path), "-o",
                  "--preview");
  }
  fs::current_path(here);
}

TEST_CASE("an output that is a link to nothing yet is what it leads to") {
  const TemporaryFolder folder;
  touch(folder, "human.glb");
  fs::create_symlink("new.x", folder.path / "link");
  fs::create_symlink("new.x", folder.path / "another");
  const std::string at = folder.path.string();
  for (const auto& [output, report] : {std::pair("link", "new.x"), {"new.x", "link"}, {"link", "another"}}) {
    check_refused(folder.path, fmt::format("bake {0}/human.glb -o {0}/{1} --report {0}/{2}", at, output, report), "-o",
                  "--report");
  }
  fs::create_symlink("none/new.x", folder.path / "nowhere");
  check_error(run(fmt::format("bake {0}/human.glb -o {0}/nowhere", at)), 3,
              {"/nowhere: cannot be created (there is no folder ", "/none)"});
}

TEST_CASE("each output that is a link stays one, and what it leads to is replaced, if it is of the same kind" *
          doctest::test_suite("long runs")) {
  const TemporaryFolder folder;
  const std::string at = folder.path.string();
  for (const char* output : {"asset", "report", "preview"}) {
    fs::create_symlink(std::string("new ") + output, folder.path / output);
  }
  const std::string bake = fmt::format("bake {} -o {}/asset --report {}/report", kHumanFile, at, at);
  const tool::Run baked = run(fmt::format("{} --preview {}/preview", bake, at));
  REQUIRE_MESSAGE(baked.code == 0, baked.error);
  CHECK(contents(folder.path / "new asset") == contents(baked_files().asset));
  CHECK(contents(folder.path / "new preview").rfind("glTF", 0) == 0);
  const std::string report = contents(folder.path / "new report");
  const std::string play = fmt::format("play {}/asset --source {} --frames 1 --json {}/", at, kHumanFile, at);
  CHECK(run(play + "report").code == 0);
  CHECK(contents(folder.path / "new report") != report);
  for (const char* output : {"asset", "report", "preview"}) CHECK(fs::is_symlink(folder.path / output));
  CHECK(files_in(folder.path) == 6);

  folder.write("new asset", "precious");
  check_error(run(bake), 3, {"/asset: exists and is not an asset"});
  CHECK(contents(folder.path / "new asset") == "precious");
}

TEST_CASE("reports and tables replace those that the tool wrote, and nothing else") {
  const TemporaryFolder folder;
  const std::string asset = baked_files().asset.string(), play = fmt::format("play {} --source {} ", asset, kHumanFile),
                    validate = fmt::format("validate {} --source {} ", asset, kHumanFile);
  const fs::path report = folder.path / "report.json";
  fs::copy(baked_files().report, report);
  // One after the other over the same file: what each writes, each replaces.
  for (const std::string& command : {play, validate, play + "--radius fit "}) {
    const std::string before = contents(report);
    const tool::Run done =
        run(fmt::format("{} --frames 1 --json {}", command, report.string()), "SPHERECHAIN_CACHE=off");
    CHECK_MESSAGE(done.code == 0, done.error);
    CHECK(contents(report) != before);
  }
  const std::string thesis = folder.write("thesis.json", "{\"years\": 4}").string();
  for (const std::string& command : {play, validate}) {
    check_error(run(fmt::format("{} --json {}", command, thesis)), 3, {"thesis.json", "exists", "move it"});
  }
  const std::string bake = fmt::format("bake {} -o {}/new.sphc --report ", kHumanFile, folder.path.string());
  check_error(run(bake + thesis), 3, {"thesis.json", "exists", "--force"});
  CHECK(contents(thesis) == "{\"years\": 4}");
  CHECK(files_in(folder.path) == 2);
}

TEST_CASE("one rule for every output: a file that somebody else wrote is kept, however like the tool's own it is") {
  const TemporaryFolder folder;
  const std::string at = folder.path.string();
  touch(folder, "human.glb");
  touch(folder, "take.bvh");
  const std::string gltf = R"({"asset":{"version":"2.0","generator":"not spherechain","extras":{"by":"me"}}})";
  const std::string glb =
      std::string("glTF\2\0\0\0\0\0\0\0", 12) + static_cast<char>(gltf.size()) + std::string("\0\0\0JSON", 7) + gltf;
  const std::string page = "<!doctype html>\n<title>spherechain, a review</title>", bvh = "HIERARCHY\nROOT hip\n",
                    table = "{\n \"frames\": 3,\n \"writer\": \"somebody\"\n}\n",
                    sarif = "{\n \"$schema\": \"https://json.schemastore.org/sarif-2.1.0.json\",\n \"runs\": []\n}\n",
                    junit = "<?xml version=\"1.0\"?>\n<testsuites>\n <testsuite name=\"mine\"/></testsuites>\n";
  struct Row {
    const char* command;
    const char* file;
    const std::string& foreign;
  };
  for (const auto& [command, file, foreign] :
       std::initializer_list<Row>{{"bake {0}/human.glb -o", "a.sphc", glb},
                                  {"bake {0}/human.glb -o {0}/out --report", "a.json", table},
                                  {"bake {0}/human.glb -o {0}/out --preview", "a.glb", glb},
                                  {"play a.sphc --source {0}/human.glb --json", "a.json", table},
                                  {"validate a.sphc --source {0}/human.glb --json", "a.json", table},
                                  {"view a.sphc --source {0}/human.glb -o", "a.html", page},
                                  {"filter a.sphc --source {0}/human.glb -o", "a.json", table},
                                  {"export a.sphc --to mjcf -o", "a.xml", junit},
                                  {"export a.sphc --to unity -o", "a.json", table},
                                  {"export a.sphc --source {0}/human.glb --to khr -o", "a.glb", glb},
                                  {"fix {0}/human.glb -o", "a.glb", glb},
                                  {"fix {0}/human.glb --motion {0}/take.bvh -o", "a.bvh", bvh},
                                  {"check {0}/human.glb -o {0}/out --json", "a.json", table},
                                  {"check {0}/human.glb -o {0}/out --junit", "a.xml", junit},
                                  {"check {0}/human.glb -o {0}/out --sarif", "a.sarif", sarif},
                                  {"check {0}/human.glb -o {0}/out --accept --baseline", "a.json", table},
                                  {"check {0}/human.glb --shard 1/1 -o {0} --cache {0}/out #", "shard.json", table}}) {
    CAPTURE(command);
    const fs::path path = folder.write(file, foreign);
    check_error(run(fmt::format("{} {}", fmt::format(fmt::runtime(command), at), path.string())), 3, {path.string()});
    CHECK(contents(path) == foreign);
    fs::remove(path);
  }
  CHECK(files_in(folder.path) == 2);
}

TEST_CASE("an output may have any name that the system takes, and is not a folder, a name too long or a full device") {
  const TemporaryFolder folder;
  fs::create_directory(folder.path / "folder");
  const std::string play =
      fmt::format("play {} --source {} --frames 1 --json ", baked_files().asset.string(), kHumanFile);
  const auto path = [&](const std::string& name) { return (folder.path / name).string(); };
  // Bytes that are no UTF-8, an escape sequence, blanks, a first dash.
  const std::string odd = "-a \xff\x1b[31m b";
  const tool::Run done = run(fmt::format("{}\"{}\"", play, path(odd)));
  CHECK_MESSAGE(done.code == 0, done.error);
  CHECK(contents(path(odd)).starts_with("{\n \"writer\""));
  check_error(run(play + path("folder")), 3, {"it is a folder"});
  check_error(run(play + path("new/")), 3, {"new/"});
  check_error(run(play + path(std::string(300, 'x'))), 3, {"too long"});
  check_error(run(play + path("folder/../none/x")), 3, {"no folder"});
  check_error(run(play + "/dev/full"), 3, {"/dev/full: cannot be written"});
  CHECK(files_in(folder.path) == 2);
}
