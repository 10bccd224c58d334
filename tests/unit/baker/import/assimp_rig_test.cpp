// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "baker/import/import.h"
#include "baker/motion/clip.h"
#include "human.h"
#include "refusal.h"
#include "temporary_folder.h"

using namespace spherechain::baker;
namespace fs = std::filesystem;

namespace {

std::vector<Vec3> posed(const SourceMesh& mesh, const std::string& clip, double seconds) {
  const auto found = std::find_if(mesh.rig.clips.begin(), mesh.rig.clips.end(),
                                  [&](const Clip& c) { return clip.empty() || c.name == clip; });
  REQUIRE(found != mesh.rig.clips.end());
  const Deformation deformation = sample(mesh.rig, *found, seconds);
  return deform(morph(mesh.positions, mesh.rig.morphs, deformation.morphs), mesh.rig.weights, deformation.bones);
}

// As a fraction of the mesh's size.
double farthest(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  REQUIRE(a.size() == b.size());
  Eigen::AlignedBox3d box;
  double most = 0;
  for (std::size_t v = 0; v < a.size(); ++v) {
    box.extend(a[v]);
    most = std::max(most, (a[v] - b[v]).norm());
  }
  return most / box.diagonal().norm();
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

std::string source(const std::string& id, const std::string& values, std::size_t count, int stride,
                   const std::string& names, const char* type = "float") {
  std::string out = "<source id='" + id + "'><" + type + "_array id='" + id + "-a' count='" + std::to_string(count) +
                    "'>" + values + "</" + type + "_array><technique_common><accessor source='#" + id + "-a' count='" +
                    std::to_string(count / static_cast<std::size_t>(stride)) + "' stride='" + std::to_string(stride) +
                    "'>";
  for (const char c : names) {
    out += std::string("<param name='") +
           (c == 'J'   ? "JOINT"
            : c == 'M' ? "TRANSFORM"
            : c == 'W' ? "WEIGHT"
            : c == 'T' ? "TIME"
            : c == 'A' ? "ANGLE"
                       : std::string(1, c)) +
           "' type='" +
           (c == 'J'   ? "name"
            : c == 'M' ? "float4x4"
                       : "float") +
           "'/>";
  }
  return out + "</accessor></technique_common></source>";
}

// An arm along x, bent at (1, 0, 0) about z by 90 degrees from second 1 to second 3; a triangle at (1, 5, 0) hangs on
// the fore arm. The node of the skinned mesh is turned about x and moved, which Collada leaves out of a skin.
const std::string kArm =
    "<?xml version='1.0'?><COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema' version='1.4.1'>"
    "<asset><up_axis>Y_UP</up_axis></asset><library_geometries>"
    "<geometry id='g'><mesh>" +
    source("p", "0 0 0 1 0 0 2 0 0 1 1 0", 12, 3, "XYZ") +
    "<vertices id='v'><input semantic='POSITION' source='#p'/></vertices><triangles count='2'>"
    "<input semantic='VERTEX' source='#v' offset='0'/><p>0 1 3 1 2 3</p></triangles></mesh></geometry>"
    "<geometry id='h'><mesh>" +
    source("hp", "0 5 0 1 5 0 0 6 0", 9, 3, "XYZ") +
    "<vertices id='hv'><input semantic='POSITION' source='#hp'/></vertices><triangles count='1'>"
    "<input semantic='VERTEX' source='#hv' offset='0'/><p>0 1 2</p></triangles></mesh></geometry>"
    "</library_geometries><library_controllers><controller id='c'><skin source='#g'>"
    "<bind_shape_matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</bind_shape_matrix>" +
    source("j", "upper fore", 2, 1, "J", "Name") +
    source("ib", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1  1 0 0 -1 0 1 0 0 0 0 1 0 0 0 0 1", 32, 16, "M") +
    source("w", "1 0.5 0.25", 3, 1, "W") +
    "<joints><input semantic='JOINT' source='#j'/><input semantic='INV_BIND_MATRIX' source='#ib'/></joints>"
    "<vertex_weights count='4'><input semantic='JOINT' source='#j' offset='0'/><input semantic='WEIGHT' source='#w' "
    "offset='1'/><vcount>1 2 1 2</vcount><v>0 0  0 1 1 2  1 0  0 1 1 1</v></vertex_weights></skin></controller>"
    "</library_controllers><library_animations><animation id='a'>" +
    source("t", "1 3", 2, 1, "T") + source("o", "0 90", 2, 1, "A") + source("i", "LINEAR LINEAR", 2, 1, "I", "Name") +
    "<sampler id='s'><input semantic='INPUT' source='#t'/><input semantic='OUTPUT' source='#o'/>"
    "<input semantic='INTERPOLATION' source='#i'/></sampler><channel source='#s' target='fore/bend.ANGLE'/>"
    "</animation></library_animations><library_visual_scenes><visual_scene id='scene'>"
    "<node id='upper' sid='upper' name='upper' type='JOINT'>"
    "<node id='fore' sid='fore' name='fore' type='JOINT'><translate>1 0 0</translate><rotate sid='bend'>0 0 1 "
    "0</rotate>"
    "<node id='held' name='held'><instance_geometry url='#h'/></node></node></node>"
    "<node id='mesh' name='mesh'><matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix><instance_controller url='#c'>"
    "<skeleton>#upper</skeleton></instance_controller></node>"
    "</visual_scene></library_visual_scenes><scene><instance_visual_scene url='#scene'/></scene></COLLADA>";

// A triangle on a node at (5, 0, 0) that is turned by 90 degrees about z before its own turn, which goes from 0 to 90
// degrees about (1, 0, 0) or its origin.
const std::string kPivots = R"(; FBX 7.4.0 project file
FBXHeaderExtension:  {
FBXHeaderVersion: 1003
FBXVersion: 7400
Creator: "test"
}
GlobalSettings:  {
Version: 1000
Properties70:  {
P: "UpAxis", "int", "Integer", "",1
P: "UnitScaleFactor", "double", "Number", "",1
}
}
Objects:  {
Geometry: 10, "Geometry::held", "Mesh" {
Vertices: *9 {
a: 1,0,0,2,0,0,1,1,0
}
PolygonVertexIndex: *3 {
a: 0,1,-3
}
GeometryVersion: 124
}
Model: 20, "Model::joint", "LimbNode" {
Version: 232
Properties70:  {
P: "RotationActive", "bool", "", "",1
P: "PreRotation", "Vector3D", "Vector", "",0,0,90
P: "RotationPivot", "Vector3D", "Vector", "",PIVOT
P: "Lcl Translation", "Lcl Translation", "", "A",5,0,0
}
}
Model: 30, "Model::held", "Mesh" {
Version: 232
}
AnimationStack: 40, "AnimStack::turn", "" {
}
AnimationLayer: 50, "AnimLayer::base", "" {
}
AnimationCurveNode: 60, "AnimCurveNode::R", "" {
Properties70:  {
P: "d|X", "Number", "", "A",0
P: "d|Y", "Number", "", "A",0
P: "d|Z", "Number", "", "A",0
}
}
AnimationCurve: 70, "AnimCurve::", "" {
Default: 0
KeyVer: 4008
KeyTime: *2 {
a: 0,46186158000
}
KeyValueFloat: *2 {
a: 0,90
}
}
}
Connections:  {
C: "OO",20,0
C: "OO",30,20
C: "OO",10,30
C: "OO",50,40
C: "OO",60,50
C: "OP",60,20, "Lcl Rotation"
C: "OP",70,60, "d|Z"
}
)";

}  // namespace

TEST_CASE("the clip of an X file that holds the bind pose leaves the rest positions where they are") {
  const SourceMesh wuson = read_with_assimp(kModels / "X/Testwuson.X");
  CHECK(wuson.rig.clips.size() == 3);
  CHECK(farthest(wuson.positions, posed(wuson, "Wuson_Bind", 0)) < 1e-5);  // singles
  CHECK(farthest(wuson.positions, posed(wuson, "Wuson_Run", 0)) > 0.01);
}

TEST_CASE("an X file that names no unit of time counts Direct3D's ticks, or frames where keys are as close as those") {
  const auto text = [](const std::string& end) {
    return "xof 0303txt 0032\nFrame a { FrameTransformMatrix { "
           "1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0,0.0,0.0,0.0,0.0,1.0;; }\n"
           "Mesh { 3; 0;0;0;, 1;0;0;, 0;1;0;; 1; 3;0,1,2;; } }\n"
           "AnimationSet s { Animation { { a } AnimationKey { 2; 2; 0;3;0.0,0.0,0.0;;, " +
           end + ";3;0.0,0.0,1.0;;; } } }\n";
  };
  const TemporaryFolder folder;
  for (const std::string end : {"4800", "25"}) {
    const SourceMesh mesh = read_with_assimp(folder.write("man.x", text(end)));
    REQUIRE(mesh.rig.clips.size() == 1);
    CHECK(mesh.rig.clips[0].duration == doctest::Approx(1));
  }
}

TEST_CASE("meshes of one character whose nodes scatter them are at rest where their bones were bound") {
  // The head's node has it in front of the neck; the clip starts in the bind pose.
  const SourceMesh human = read_with_assimp(kModels / "X/BCN_Epileptic.X");
  CHECK(human.meshes == 3);
  CHECK(farthest(human.positions, posed(human, "", 0)) < 1e-4);
  CHECK(human.rig.clips[0].duration == doctest::Approx(3.3));
}

TEST_CASE("the clip of an FBX file starts where its mesh rests, though its node scales by 100") {
  const SourceMesh bones = read_with_assimp(kModels / "FBX/huesitos.fbx");
  CHECK(farthest(bones.positions, posed(bones, "", 0)) < 1e-5);
  CHECK(farthest(bones.positions, posed(bones, "", 0.8)) > 0.05);
}

TEST_CASE("weights are the largest, in order, and sum to 1") {
  const SourceMesh human = read_with_assimp(kModels / "X/BCN_Epileptic.X");
  REQUIRE(human.rig.weights.size() == human.positions.size());
  for (const VertexWeights& w : human.rig.weights) {
    double sum = 0;
    for (std::size_t k = 0; k < kMaxInfluences; ++k) {
      sum += w.weight[k];
      CHECK(w.joint[k] < human.rig.bones.size());
      if (k > 0) CHECK(w.weight[k] <= w.weight[k - 1]);
    }
    CHECK(sum == doctest::Approx(1).epsilon(1e-12));
  }
}

TEST_CASE("a skin bends at its joint, and what hangs on a bone goes with it") {
  const TemporaryFolder folder;
  const SourceMesh arm = read_with_assimp(folder.write("arm.dae", kArm));
  REQUIRE(arm.positions.size() == 9);  // the held triangle first, as the scene has it
  REQUIRE(arm.rig.clips.size() == 1);
  CHECK(arm.rig.clips[0].duration == doctest::Approx(2));  // from its first key to its last
  CHECK(farthest(arm.positions, posed(arm, "", 0)) < 1e-6);
  const std::vector<Vec3> bent = posed(arm, "", 2);
  for (std::size_t v = 0; v < 9; ++v) {
    const Vec3& p = arm.positions[v];
    const Vec3 turned(1 - p.y(), p.x() - 1, p.z());
    CAPTURE(p.transpose());
    Vec3 expected = turned;  // held, or all on the fore arm
    if (v >= 3 && p == Vec3(0, 0, 0)) expected = p;
    if (v >= 3 && p == Vec3(1, 0, 0)) expected = p;  // the joint itself
    if (v >= 3 && p == Vec3(1, 1, 0)) expected = 0.5 * (p + turned);
    CHECK(bent[v].isApprox(expected, 1e-5));
  }
}

TEST_CASE("a node that Collada leaves out of a skin gives the rest positions neither place nor axes of their own") {
  const TemporaryFolder folder;
  const SourceMesh plain = read_with_assimp(folder.write("arm.dae", kArm));
  const std::string node = "<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix>";
  // A quarter turn about x, and a hundred times the size.
  const SourceMesh turned = read_with_assimp(
      folder.write("turned.dae", replaced(kArm, node, "<matrix>100 0 0 0 0 0 -100 0 0 100 0 0 0 0 0 1</matrix>")));
  CHECK(farthest(plain.positions, turned.positions) < 1e-6);
  CHECK(farthest(posed(plain, "", 2), posed(turned, "", 2)) < 1e-6);
}

TEST_CASE("numbers that are not finite in a skin or a clip are refused with the bone's name") {
  const TemporaryFolder folder;
  CHECK(contains(refusal(folder.write("key.dae", replaced(kArm, ">0 90<", ">0 nan<"))), "a key of 'fore'"));
  CHECK(contains(refusal(folder.write("bind.dae", replaced(kArm, "1 0 0 -1 ", "1 0 0 inf "))), "bone 'fore'"));
  CHECK(contains(refusal(folder.write("node.dae", replaced(kArm, "<translate>1 0 0<", "<translate>1 inf 0<"))),
                 "node 'fore'"));
}

TEST_CASE("a file without anything that moves has no rig, and sticks drawn for bones are no mesh") {
  const TemporaryFolder folder;
  const SourceRig rig = read_with_assimp(folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")).rig;
  CHECK(rig.nodes.empty());
  CHECK(rig.weights.empty());
  const SourceMesh capture = read_with_assimp(kModels / "BVH/01_03.bvh");
  CHECK(capture.triangles.empty());
  CHECK(capture.rig.nodes.size() == 38);
  CHECK(capture.rig.bones.empty());
  REQUIRE(capture.rig.clips.size() == 1);
  CHECK(capture.rig.clips[0].duration == doctest::Approx(4510 / 120.0).epsilon(1e-4));
}

TEST_CASE("FBX pivots become part of their node, in its clips too") {
  const TemporaryFolder folder;
  // assimp animates the first as one node, the second pivot by pivot.
  for (const double pivot : {0.0, 1.0}) {
    const SourceMesh held =
        read_with_assimp(folder.write("pivots.fbx", replaced(kPivots, "PIVOT", pivot == 0 ? "0,0,0" : "1,0,0")));
    REQUIRE(held.rig.nodes.size() == 3);
    CHECK(held.rig.nodes[1].name == "joint");
    const auto expected = [&](double degrees, const Vec3& p) {
      const double a = (90 + degrees) * std::numbers::pi / 180, x = p.x() - pivot, y = p.y();
      return Vec3(5 + pivot + std::cos(a) * x - std::sin(a) * y, std::sin(a) * x + std::cos(a) * y, 0);
    };
    const std::vector<Vec3> corners{{1, 0, 0}, {2, 0, 0}, {1, 1, 0}};
    for (const double seconds : {0.0, 0.517, 1.0}) {
      const std::vector<Vec3> turned = posed(held, "turn", seconds);
      for (std::size_t v = 0; v < 3; ++v)
        CHECK((turned[v] - expected(90 * seconds, corners[v])).norm() < 1e-3);  // chords of 3 degrees
    }
    for (std::size_t v = 0; v < 3; ++v) CHECK((held.positions[v] - expected(0, corners[v])).norm() < 1e-5);
    // The joint is where it turns.
    REQUIRE(held.rig.pivots.size() == (pivot == 0 ? 0 : 3));
    if (pivot != 0) CHECK((held.rig.pivots[1] - expected(0, {1, 0, 0})).norm() < 1e-5);
  }
  // A pivot that no clip turns about says nothing, and rounded keys are no turn.
  const std::string still = replaced(replaced(kPivots, "PIVOT", "1,0,0"), "a: 0,90", "a: 0,0.0001");
  CHECK(read_with_assimp(folder.write("still.fbx", still)).rig.pivots.empty());
}

TEST_CASE("a Collada file's nodes are called by their names, whether these are unique or not") {
  const TemporaryFolder folder;
  const SourceMesh plain = read_with_assimp(folder.write("plain.dae", kArm));
  for (const auto& [upper, fore] : {std::pair("Oberarm links", "Unterarm"), {"bone", "bone"}}) {
    CAPTURE(upper);
    const SourceMesh mesh = read_with_assimp(
        folder.write("arm.dae", replaced(replaced(kArm, "name='upper' type", std::string("name='") + upper + "' type"),
                                         "name='fore' type", std::string("name='") + fore + "' type")));
    REQUIRE(mesh.rig.nodes.size() == plain.rig.nodes.size());
    for (std::size_t n = 0; n < mesh.rig.nodes.size(); ++n) {
      const std::string& id = plain.rig.nodes[n].name;
      CHECK(mesh.rig.nodes[n].name == (id == "upper" ? upper : id == "fore" ? fore : id));
    }
    for (const double seconds : {0.0, 1.0, 2.0})
      CHECK(farthest(posed(mesh, "", seconds), posed(plain, "", seconds)) < 1e-6);
  }
}
