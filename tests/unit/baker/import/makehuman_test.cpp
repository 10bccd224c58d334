// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies by MakeHuman's targets, from a folder in the layout of its data.
#include "baker/import/makehuman.h"

#include <doctest/doctest.h>

#include "refusal.h"
#include "temporary_folder.h"

using namespace spherechain::baker;
namespace fs = std::filesystem;

namespace {

// A box of the body, a guide for clothes, and two joints.
struct MakeHumanData {
  TemporaryFolder folder;
  MakeHumanData() {
    for (const char* name : {"3dobjs", "rigs", "targets/macrodetails/height"})
      fs::create_directories(folder.path / name);
    std::string base = "# base\ng joint-hip\nv 0 -1 0\nv 0 1 0\ng body\n";
    for (int corner = 0; corner < 8; ++corner) {
      base += "v " + std::to_string(corner & 1) + " " + std::to_string(corner >> 1 & 1) + " " +
              std::to_string(corner >> 2) + "\n";
    }
    base +=
        "f 3/1 5/2 6/3 4/4\nf 7 8 10 9\nf 3 4 8 7\nf 5 9 10 6\nf 3 7 9 5\nf 4 6 10 8\n"
        "g helper-skirt\nv 9 9 9\nf 3 4 11\n";
    folder.write("3dobjs/base.obj", base);
    folder.write("rigs/default.mhskel",
                 R"({"bones": {"arm": {"head": "b", "parent": "root"}, "root": {"head": "a", "parent": null}},
                     "joints": {"a": [0, 1], "b": [2]}, "weights_file": "w.mhw"})");
    folder.write("rigs/w.mhw", R"({"weights": {"root": [[2, 0.5], [3, 1]], "arm": [[2, 1.5]]}})");
    // An offset of the first corner, which carries a joint.
    folder.write("targets/macrodetails/asian-male-young.target", "# text\n2 1 0 0\n");
    folder.write("targets/macrodetails/asian-male-old.target", "2 0 1 0\n");
    folder.write("targets/macrodetails/asian-female-child.target", "2 0 0 1\n");
    folder.write("targets/macrodetails/universal-male-young-maxmuscle-averageweight.target", "2 .5 0 0\n9 0 0 8\n");
    folder.write("targets/macrodetails/height/male-young-maxmuscle-averageweight-minheight.target", "2 0 0 -4\n");
  }
  SourceMesh make(const MakeHumanBody& body) const { return make_body(folder.path, body); }
};

MakeHumanBody asian(double gender, double age, double muscle = 0.5, double height = 0.5) {
  return {gender, age, muscle, 0.5, height, 0, 1, 0};
}

}  // namespace

TEST_CASE("a target moves a body by the product of what its name says") {
  const MakeHumanData data;
  const auto corner = [&](const MakeHumanBody& body) { return data.make(body).positions.at(0); };
  CHECK((corner(asian(1, 0.5)) - Vec3(1, 0, 0)).norm() < 1e-6);
  CHECK((corner(asian(1, 0.75)) - Vec3(0.5, 0.5, 0)).norm() < 1e-6);
  CHECK((corner(asian(0, 0.1875)) - Vec3(0, 0, 1)).norm() < 1e-6);
  CHECK((corner(asian(0.5, 0.34375)) - Vec3(0.25, 0, 0.25)).norm() < 1e-6);
  CHECK((corner(asian(1, 0.5, 0.75)) - Vec3(1.25, 0, 0)).norm() < 1e-6);
  CHECK((corner(asian(1, 0.5, 1, 0.25)) - Vec3(1.5, 0, -2)).norm() < 1e-6);
}

TEST_CASE("a made body has the skin of the base without its guides, and joints that follow its targets") {
  const MakeHumanData data;
  const SourceMesh body = data.make(asian(1, 0.5));
  CHECK(body.positions.size() == 8);
  CHECK(body.triangles.size() == 12);
  CHECK(body.metres_per_unit == 0.1);
  REQUIRE(body.rig.nodes.size() == 2);
  CHECK(body.rig.nodes[1].name == "arm");
  CHECK(body.rig.nodes[1].parent == 0);
  CHECK((world_of(body.rig.nodes)[1].translation() - Vec3(1, 0, 0)).norm() < 1e-9);
  CHECK(body.rig.weights[0].joint[0] == 1);
  CHECK(body.rig.weights[0].weight[0] == doctest::Approx(0.75));
  CHECK(body.rig.weights[1].weight[0] == 1);
  const SourceMesh glb = read_source(data.folder.write("body.glb", make_body_as_glb(data.folder.path, asian(1, 0.5))));
  CHECK(glb.positions.size() == 8);
  CHECK(glb.rig.bones.size() == 2);
}

TEST_CASE("MakeHuman's data that are missing or damaged are refused") {
  const auto says = [](const MakeHumanData& data, const MakeHumanBody& body, const char* part) {
    const std::string what = refusal(data.folder.path, [&](const auto& folder) { make_body(folder, body); });
    CAPTURE(what);
    CHECK(contains(what, part));
  };
  says(MakeHumanData(), asian(1, 0.1875), "has no .target file for this body");
  const auto with = [&](const char* name, const char* text, const char* part) {
    const MakeHumanData data;
    data.folder.write(name, text);
    says(data, asian(1, 0.5), part);
  };
  with("targets/macrodetails/asian-male-young.target", "11 0 0 0\n", "line 1: no vertex of the base");
  with("3dobjs/base.obj", "v 0 0 0\nf 1 2 1\n", "line 2: uses no vertex '2'");
  with("3dobjs/base.obj", "v 0 0\n", "line 1: no vertex");
  with("rigs/w.mhw", R"({"weights": {"arm": [[99, 1]]}})", "uses vertex 99 of 11");
  with("rigs/default.mhskel", R"({"bones": {"a": {"head": "x", "parent": null}}, "joints": {}})",
       "no skeleton of MakeHuman");
  with("rigs/default.mhskel", R"({"bones": {}, "joints": {}, "weights_file": "../w.mhw"})",
       "its weights '../w.mhw' is outside");
}
