// SPDX-License-Identifier: GPL-3.0-or-later
// Robots as URDF and MJCF describe them, with links in STL files.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>

#include "baker/import/import.h"
#include "baker/import/notes.h"
#include "refusal.h"
#include "small_robot.h"

using namespace spherechain::baker;
using small_robot::with;

namespace {

std::string refusal_of(const std::string& urdf) {
  const small_robot::Files files;
  return refusal(files.urdf(urdf));
}

// The box of the vertices that a bone of that name moves.
Eigen::AlignedBox3d box_of(const SourceMesh& robot, const std::string& link) {
  Eigen::AlignedBox3d out;
  for (std::size_t v = 0; v < robot.positions.size(); ++v) {
    const Bone& bone = robot.rig.bones[robot.rig.weights[v].joint[0]];
    if (robot.rig.nodes[bone.node].name == link) out.extend(robot.positions[v]);
  }
  return out;
}

std::vector<std::string> bone_names(const SourceMesh& robot) {
  std::vector<std::string> out;
  for (const Bone& bone : robot.rig.bones) out.push_back(robot.rig.nodes[bone.node].name);
  return out;
}

}  // namespace

TEST_CASE("a URDF's links lie at rest where its joints put them, and fixed joints join links") {
  const small_robot::Files files;
  const SourceMesh robot = read_source(files.urdf());
  CHECK(bone_names(robot) == std::vector<std::string>{"base", "lower", "upper", "lamp"});
  CHECK(box_of(robot, "lower").min().isApprox(Vec3(-0.05, -0.05, 0.06), 1e-6));
  CHECK(box_of(robot, "lower").max().isApprox(Vec3(0.05, 0.05, 0.56), 1e-6));
  // The upper arm is scaled to 0.6, and the tool's sphere stands at its end.
  CHECK(box_of(robot, "upper").max().isApprox(Vec3(0.06, 0.18, 1.11 + 0.11), 1e-6));
  CHECK(robot.rig.robot.joints.size() == 3);
  CHECK(robot.rig.robot.joints[1].upper == 3);
  CHECK(robot.rig.robot.joints[2].mimic == 1);
  const std::vector<std::array<Index, 2>> neighbours{{0, 1}, {1, 2}, {2, 3}};
  CHECK(robot.rig.robot.excluded == neighbours);
  CHECK(robot.up_hint == Vec3::UnitZ());
}

TEST_CASE("a link without a mesh to see takes its collision geometry") {
  const small_robot::Files files;
  const std::string visual = "<visual><geometry><box size=\"0.3 0.3 0.1\"/></geometry></visual>";
  const SourceMesh robot = read_source(files.urdf(with(small_robot::kUrdf, visual, "")));
  CHECK(box_of(robot, "base").max().isApprox(Vec3(0.2, 0.2, 0.05), 1e-6));
}

TEST_CASE("a robot's meshes lie in its folder or in its package") {
  const small_robot::Files files;
  std::filesystem::create_directories(files.folder / "urdf");
  const std::string up = with(small_robot::kUrdf, "\"meshes/link.stl\"", "\"../meshes/link.stl\"");
  const std::filesystem::path file = files.write("urdf/arm.urdf", up);
  CHECK(contains(refusal(file), "which is outside the folder of the file"));
  files.write("package.xml", "<package><name>other</name></package>");
  CHECK(refusal(file) == "accepted");
  files.write("urdf/named.urdf", with(up, "package://arm/", "package://other/"));
  CHECK(refusal(files.folder / "urdf/named.urdf") == "accepted");
  files.temporary.write("secret.stl", small_robot::box_stl(1, 1, 1));
  for (const char* name :
       {"../../secret.stl", "package://arm/../secret.stl", "package://arm/meshes/../../secret.stl"}) {
    const auto text = with(small_robot::kUrdf, "\"meshes/link.stl\"", '"' + std::string(name) + '"');
    CHECK(contains(refusal(files.write("urdf/evil.urdf", text)), "which is outside"));
  }
  // A folder around it is no package because a stranger's file says so.
  const std::string around = files.temporary.path.filename().string();
  std::filesystem::create_directories(files.folder / "urdf/deep");
  CHECK(!contains(refusal(files.write("urdf/deep/evil.urdf", with(small_robot::kUrdf, "\"meshes/link.stl\"",
                                                                  "\"package://" + around + "/secret.stl\""))),
                  "accepted"));
  std::filesystem::create_symlink(files.temporary.path / "secret.stl", files.folder / "meshes/link2.stl");
  CHECK(contains(refusal(files.urdf(with(small_robot::kUrdf, "\"meshes/link.stl\"", "\"meshes/link2.stl\""))),
                 "a link that leads out"));
}

TEST_CASE("a broken URDF is refused by name and cause") {
  const std::string& good = small_robot::kUrdf;
  CHECK(contains(refusal_of(with(good, "meshes/link.stl\" scale", "meshes/none.stl\" scale")),
                 "'meshes/none.stl', which is not there"));
  CHECK(contains(refusal_of(with(good, "<parent link=\"base\"/>", "<parent link=\"tool\"/>")), "round in a circle"));
  CHECK(contains(refusal_of(with(good, "</robot>", "<link name=\"more\"/></robot>")), "two links without a parent"));
  CHECK(contains(refusal_of(with(good, "0 0.12 0.45", "0 nan 0.45")), "'0 nan 0.45' is not 3 numbers"));
  CHECK(contains(refusal_of(with(good, "0 0.12 0.45", "0 1e999 0.45")), "is not 3 numbers"));
  CHECK(contains(refusal_of(with(good, "<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0 0\"/>")), "no length"));
  CHECK(contains(refusal_of(with(good, "joint=\"elbow\"", "joint=\"nod\"")), "mimics itself"));
  CHECK(contains(refusal_of(with(good, "scale=\"1 1 1.2\"", "scale=\"1 1 1e30\"")), "is"));
  CHECK(contains(refusal_of(with(good, "<box size=\"0.3", "<box size=\"-0.3")), "its box has no size"));
  CHECK(contains(refusal_of("<robot name=\"a\"><xacro:macro/></robot>"), "xacro"));
  CHECK(contains(refusal_of("<robot name=\"a\"><link"), "is no XML"));
}

TEST_CASE("entities do not grow, and deep XML ends in an error") {
  std::string bomb = "<!DOCTYPE robot [<!ENTITY a \"aaaaaaaaaa\">";
  for (char c = 'b'; c < 'k'; ++c) {
    bomb += std::string("<!ENTITY ") + c + " \"";
    for (int i = 0; i < 10; ++i) bomb += std::string("&") + static_cast<char>(c - 1) + ";";
    bomb += "\">";
  }
  const small_robot::Files files;
  const auto robot = read_source(files.urdf(with(with(small_robot::kUrdf, "<robot", bomb + "]><robot"),
                                                 "<link name=\"lamp\">", "<link name=\"lamp\" note=\"&j;\">")));
  CHECK(robot.rig.bones.size() == 4);
  std::string deep = "<mujoco><worldbody>";
  for (int i = 0; i < 100'000; ++i) deep += "<body>";
  CHECK(refusal(files.write("deep.xml", deep)) != "accepted");
}

TEST_CASE("an MJCF's defaults, frames, angles and groups are read") {
  const small_robot::Files files;
  const SourceMesh robot = read_source(files.write("arm.xml", R"(<mujoco model="small">
  <compiler angle="radian" meshdir="meshes"/>
  <default><geom contype="0" conaffinity="0"/>
    <default class="hull"><geom group="3" contype="1" type="box" size="0.1 0.1 0.3"/></default></default>
  <asset><mesh file="link.stl" scale="2 2 1"/></asset>
  <worldbody><geom type="plane" size="1 1 1"/>
    <body name="base" pos="0 0 1"><geom type="mesh" mesh="link"/><geom class="hull"/>
      <body name="arm" pos="0.2 0 0" euler="0 1.5707963 0"><joint name="hinge" axis="0 1 0" range="-1 2" ref="0.5"/>
        <geom type="capsule" fromto="0 0 0 0 0 0.4" size="0.05"/>
        <frame pos="0 0 0.4"><geom type="ellipsoid" size="0.1 0.2 0.3"/></frame></body></body></worldbody>
  <contact><exclude body1="base" body2="arm"/></contact></mujoco>)"));
  CHECK(bone_names(robot) == std::vector<std::string>{"base", "arm"});
  CHECK(box_of(robot, "base").min().isApprox(Vec3(-0.1, -0.1, 1), 1e-6));
  CHECK(box_of(robot, "base").max().isApprox(Vec3(0.1, 0.1, 1.5), 1e-6));
  // Turned about y, z goes to x: the ellipsoid's centre lies at 0.2 + 0.4.
  CHECK(box_of(robot, "arm").max().isApprox(Vec3(0.9, 0.2, 1.1), 1e-5));
  CHECK(robot.rig.robot.colliders.size() == 1);
  REQUIRE(robot.rig.robot.joints.size() == 1);
  CHECK(robot.rig.robot.joints[0].zero == 0.5);
  CHECK(robot.rig.robot.joints[0].upper == 2);
  const std::vector<std::string> notes = take_notes();
  CHECK(std::any_of(notes.begin(), notes.end(), [](const auto& note) { return contains(note, "geom of type plane"); }));
}

TEST_CASE("a broken MJCF is refused by name and cause") {
  const small_robot::Files files;
  const auto refused = [&](const std::string& body) {
    return refusal(files.write("a.xml", "<mujoco><worldbody>" + body + "</worldbody></mujoco>"));
  };
  CHECK(contains(refused("<body><geom type=\"mesh\" mesh=\"none\"/></body>"), "there is no mesh 'none'"));
  CHECK(contains(refused("<body><geom size=\"-1\"/></body>"), "needs 1 sizes above 0"));
  CHECK(contains(refused("<body><geom size=\"1\" class=\"none\"/></body>"), "no default class 'none'"));
  CHECK(contains(refused("<include file=\"../a.xml\"/>"), "outside the folder"));
  CHECK(contains(refused("<include file=\"a.xml\"/>"), "a.xml' twice"));
}
TEST_CASE("an MJCF's geometry lies where MuJoCo puts it") {
  const small_robot::Files files;
  files.write("meshes/tetrahedron.obj",
              "v 0 0 0\nv 0.3 0 0\nv 0 0.2 0\nv 0.05 0.05 0.5\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n");
  const SourceMesh robot = read_source(files.write("a.xml", R"(<mujoco><compiler eulerseq="zyx" meshdir="meshes"/>
  <asset><mesh name="a" file="tetrahedron.obj" scale="2 1 -1"/>
    <mesh name="b" file="tetrahedron.obj" refpos=".1 .2 .3" refquat="0.9 0.1 0.3 -0.2"/></asset>
  <worldbody><body name="one" pos=".1 .2 .3" euler="10 20 30"><joint axis="0 0 1"/>
      <geom type="mesh" mesh="a" pos="0 0 .1" axisangle="1 1 0 40"/>
    <body name="two" pos="1 0 0" xyaxes="0 1 0 -1 .2 0"><joint/><geom type="mesh" mesh="b" zaxis="1 1 1"/>
      <body name="four" pos="0 1 1"><joint type="slide"/><geom type="box" fromto="0 0 0 .3 .4 0.2" size=".05"/></body>
    </body></body></worldbody></mujoco>)"));
  // By MuJoCo 2.2.2: the corners of each geom, by mj_kinematics.
  const auto is = [&](const char* link, const Vec3& low, const Vec3& high) {
    const Eigen::AlignedBox3d box = box_of(robot, link);
    CHECK((box.min() - low).norm() < 2e-6);
    CHECK((box.max() - high).norm() < 2e-6);
  };
  is("one", {-0.133809, 0.155903, 0.011218}, {0.526188, 0.562967, 0.530332});
  is("two", {1.108566, 0.291247, -0.313767}, {1.323532, 0.744570, 0.188007});
  is("four", {0.140205, -0.302823, 1.073642}, {0.527786, -0.067812, 1.594475});
}
