// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <numbers>

#include "baker/import/import.h"
#include "baker/motion/clip.h"
#include "temporary_folder.h"

using namespace spherechain::baker;

namespace {

// FBX's published formulas, as 3ds Max and Maya evaluate them.
Affine turn(const Vec3& degrees) {
  const Vec3 r = degrees * std::numbers::pi / 180;
  return Affine(Eigen::AngleAxisd(r.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(r.y(), Vec3::UnitY()) *
                Eigen::AngleAxisd(r.x(), Vec3::UnitX()));
}
Affine move(const Vec3& by) { return Affine(Eigen::Translation3d(by)); }
Affine scale(const Vec3& by) { return Affine(Eigen::Scaling(by)); }

struct Geometric {
  Vec3 translation = Vec3::Zero(), rotation = Vec3::Zero(), scaling = Vec3::Ones();
  Affine matrix() const { return move(translation) * turn(rotation) * scale(scaling); }
};

struct Model {
  std::string name, kind;
  Vec3 translation = Vec3::Zero(), rotation = Vec3::Zero(), scaling = Vec3::Ones(), pre = Vec3::Zero(),
       post = Vec3::Zero(), pivot = Vec3::Zero();
  Geometric geometric{};
  const Model* parent = nullptr;

  Affine world(const Model* turned = nullptr, const Vec3& to = Vec3::Zero()) const {
    const Affine local = move(translation) * move(pivot) * turn(pre) * turn(this == turned ? to : rotation) *
                         turn(post).inverse() * move(-pivot) * scale(scaling);
    return parent == nullptr ? local : parent->world(turned, to) * local;
  }
};

std::string list(const auto& numbers) {
  std::ostringstream out;
  out.precision(17);
  for (const double x : numbers) out << (out.tellp() > 0 ? "," : "") << x;
  return out.str();
}

std::string array(const char* name, std::size_t count, const std::string& values) {
  return std::string(name) + ": *" + std::to_string(count) + " {\na: " + values + "\n}\n";
}

std::string matrix(const char* name, const Affine& m) {
  const Eigen::Matrix4d all = Eigen::Affine3d(m).matrix();
  return array(name, 16, list(all.reshaped()));
}

const std::vector<Vec3> kCorners{{0.2, 0.1, 0}, {1, 0.3, 0.1}, {2, -0.2, 0.4}};

// An arm of two bones: a skin on both, a mesh that hangs on the second and has a child with a mesh.
struct Arm {
  Model skin{"Skin", "Mesh"}, upper{"Upper", "LimbNode"}, fore{"Fore", "LimbNode"}, held{"Held", "Mesh"},
      child{"Child", "Mesh"};
  std::string settings;

  Arm() {
    fore.parent = &upper;
    held.parent = &fore;
    child.parent = &held;
    fore.translation = {1, 0, 0};
    held.translation = {1, 0, 0};
    child.translation = {0, 0.5, 0};
  }

  std::string text() const {
    std::string objects, links;
    int id = 100;
    const std::vector<const Model*> models{&skin, &upper, &fore, &held, &child};
    const auto link = [&](int from, int to) {
      links += "C: \"OO\"," + std::to_string(from) + "," + std::to_string(to) + "\n";
    };
    const auto id_of = [&](const Model* model) {
      return model == nullptr ? 0
                              : 1 + static_cast<int>(std::find(models.begin(), models.end(), model) - models.begin());
    };
    for (const Model* model : models) {
      objects += "Model: " + std::to_string(id_of(model)) + ", \"Model::" + model->name + "\", \"" + model->kind +
                 "\" {\nVersion: 232\nProperties70:  {\nP: \"RotationActive\", \"bool\", \"\", \"\",1\n";
      const auto property = [&](const char* name, const Vec3& value) {
        objects += std::string("P: \"") + name + "\", \"Vector3D\", \"Vector\", \"\"," + list(value) + "\n";
      };
      property("Lcl Translation", model->translation);
      property("Lcl Rotation", model->rotation);
      property("Lcl Scaling", model->scaling);
      property("PreRotation", model->pre);
      property("PostRotation", model->post);
      property("RotationPivot", model->pivot);
      property("GeometricTranslation", model->geometric.translation);
      property("GeometricRotation", model->geometric.rotation);
      property("GeometricScaling", model->geometric.scaling);
      objects += "}\n}\n";
      link(id_of(model), id_of(model->parent));
      if (model->kind != "Mesh") continue;
      std::vector<double> corners;
      for (const Vec3& p : kCorners) corners.insert(corners.end(), p.begin(), p.end());
      objects += "Geometry: " + std::to_string(++id) + ", \"Geometry::" + model->name + "\", \"Mesh\" {\n" +
                 array("Vertices", corners.size(), list(corners)) + array("PolygonVertexIndex", 3, "0,1,-3") +
                 "GeometryVersion: 124\n}\n";
      link(id, id_of(model));
    }
    const int geometry = 101, deformer = ++id;
    objects += "Deformer: " + std::to_string(deformer) + ", \"Deformer::\", \"Skin\" {\nVersion: 101\n}\n";
    link(deformer, geometry);
    // The first corner on the upper bone, the last on the fore arm, the middle one on both.
    for (const Model* bone : {&upper, &fore}) {
      const bool first = bone == &upper;
      objects += "Deformer: " + std::to_string(++id) + ", \"SubDeformer::\", \"Cluster\" {\nVersion: 100\n" +
                 array("Indexes", 2, first ? "0,1" : "1,2") + array("Weights", 2, first ? "1,0.25" : "0.75,1") +
                 matrix("Transform", bone->world().inverse() * skin.world()) + matrix("TransformLink", bone->world()) +
                 "}\n";
      link(id, deformer);
      link(id_of(bone), id);
    }
    return "; FBX 7.4.0 project file\nFBXHeaderExtension:  {\nFBXHeaderVersion: 1003\nFBXVersion: 7400\n}\n"
           "GlobalSettings:  {\nVersion: 1000\nProperties70:  {\n" +
           settings + "}\n}\nObjects:  {\n" + objects +
           "AnimationStack: 40, \"AnimStack::bend\", \"\" {\n}\nAnimationLayer: 50, \"AnimLayer::base\", \"\" {\n}\n"
           "AnimationCurveNode: 60, \"AnimCurveNode::R\", \"\" {\nProperties70:  {\n"
           "P: \"d|X\", \"Number\", \"\", \"A\"," +
           list(std::array{fore.rotation.x()}) + "\n" + "P: \"d|Y\", \"Number\", \"\", \"A\"," +
           list(std::array{fore.rotation.y()}) + "\n" +
           "P: \"d|Z\", \"Number\", \"\", \"A\",0\n}\n}\n"
           "AnimationCurve: 70, \"AnimCurve::\", \"\" {\nDefault: 0\nKeyVer: 4008\n" +
           array("KeyTime", 2, "0,46186158000") + array("KeyValueFloat", 2, "0,80") + "}\n}\nConnections:  {\n" +
           links + "C: \"OO\",50,40\nC: \"OO\",60,50\nC: \"OP\",60,3, \"Lcl Rotation\"\nC: \"OP\",70,60, \"d|Z\"\n}\n";
  }

  // Where the corners of Skin, Held and Child are while the fore arm is bent.
  std::vector<Vec3> bent(double degrees) const {
    const Vec3 to(fore.rotation.x(), fore.rotation.y(), degrees);
    std::vector<Vec3> out;
    for (std::size_t v = 0; v < 3; ++v) {
      const double weight = std::array{0.0, 0.75, 1.0}[v];
      const Vec3 p = skin.world() * skin.geometric.matrix() * kCorners[v];
      out.push_back((1 - weight) * p + weight * (fore.world(&fore, to) * fore.world().inverse() * p));
    }
    for (const Model* mesh : {&held, &child}) {
      for (const Vec3& corner : kCorners) out.push_back(mesh->world(&fore, to) * mesh->geometric.matrix() * corner);
    }
    return out;
  }
};

void check_against_formulas(const Arm& arm) {
  const TemporaryFolder folder;
  const SourceMesh mesh = read_with_assimp(folder.write("arm.fbx", arm.text()));
  REQUIRE(mesh.positions.size() == 9);
  REQUIRE(mesh.rig.clips.size() == 1);
  for (const double seconds : {0.0, 1.0}) {
    const std::vector<Vec3> expected = arm.bent(80 * seconds),
                            got = deform(mesh.positions, mesh.rig.weights,
                                         sample(mesh.rig, mesh.rig.clips[0], seconds).bones);
    for (std::size_t v = 0; v < 9; ++v) {
      CAPTURE(seconds);
      CAPTURE(v);
      CAPTURE(got[v].transpose());
      CAPTURE(expected[v].transpose());
      CHECK((got[v] - expected[v]).norm() < 1e-4);  // singles
      if (seconds == 0) CHECK((mesh.positions[v] - expected[v]).norm() < 1e-4);
    }
  }
  // The joints are where the bones are, whatever shape the bones have.
  const std::vector<Affine> world = world_of(mesh.rig.nodes);
  for (const Model* bone : {&arm.upper, &arm.fore}) {
    const auto is_bone = [&](const Node& node) {
      const auto n = static_cast<std::size_t>(&node - mesh.rig.nodes.data());
      return node.name == bone->name && (world[n].translation() - bone->world().translation()).norm() < 1e-4;
    };
    CHECK(std::any_of(mesh.rig.nodes.begin(), mesh.rig.nodes.end(), is_bone));
  }
}

const std::vector<Geometric> kGeometric{{{0.3, 0.1, -0.2}},
                                        {Vec3::Zero(), {30, 40, 50}},
                                        {Vec3::Zero(), Vec3::Zero(), {2, 0.5, 3}},
                                        {Vec3::Zero(), Vec3::Zero(), {-1, 1, 1}},
                                        {{1, 2, 3}, {20, -70, 110}, {0.5, 2, 1.5}}};

}  // namespace

TEST_CASE("an FBX file's geometric transforms move their own mesh, skinned or not, and nothing else") {
  for (const Geometric& geometric : kGeometric) {
    for (Model Arm::*of : {&Arm::skin, &Arm::held, &Arm::child, &Arm::fore, &Arm::upper}) {
      Arm arm;
      (arm.*of).geometric = geometric;
      CAPTURE((arm.*of).name);
      check_against_formulas(arm);
    }
  }
}

TEST_CASE("geometric transforms go with turned, scaled and pivoted nodes, other axes and other units") {
  for (const std::string unit : {"1", "2.54", "100"}) {
    Arm arm;
    arm.settings = "P: \"UpAxis\", \"int\", \"Integer\", \"\"," + std::string(unit == "1" ? "1" : "2") +
                   "\nP: \"UnitScaleFactor\", \"double\", \"Number\", \"\"," + unit + "\n";
    for (Model* model : {&arm.skin, &arm.upper, &arm.fore, &arm.held}) model->geometric = kGeometric.back();
    arm.skin.translation = {3, 0, 1};
    arm.skin.pre = {-90, 0, 0};
    arm.skin.scaling = {2, 2, 2};
    arm.upper.translation = {0.5, 0.5, 0};
    arm.upper.pre = {0, 90, 15};
    arm.upper.rotation = {10, 0, 20};
    arm.fore.pre = {0, 0, 30};
    arm.held.pivot = {1, 0.5, 0};
    arm.held.rotation = {0, 60, 0};
    check_against_formulas(arm);
  }
}

TEST_CASE("an FBX file's post-rotations are taken back, in clips of nodes with pivots and without") {
  for (const Vec3& pivot : {Vec3(0, 0, 0), Vec3(0.1, 0.2, 0.3)}) {
    Arm arm;
    arm.upper.post = {0, 90, 15};
    arm.fore.pre = {20, 0, 30};
    arm.fore.post = {-50, 10, 70};
    arm.fore.pivot = pivot;
    arm.held.post = {90, 0, 0};
    check_against_formulas(arm);
  }
}

TEST_CASE("post-rotations are taken back where a node mirrors, too") {
  for (const Vec3& scaling : {Vec3(-1, 1, 1), Vec3(1, -2, 1), Vec3(1, 1, -1), Vec3(-1, -1, -1), Vec3(-1, 0.5, -1)}) {
    CAPTURE(scaling.transpose());
    Arm arm;
    arm.upper.scaling = {1, 1, -1};
    arm.fore.pre = {20, 0, 30};
    arm.fore.post = {-50, 10, 70};
    arm.fore.scaling = scaling;
    check_against_formulas(arm);
  }
}

TEST_CASE("an axis of an FBX node without a curve keeps the value that the file has for it") {
  for (const Vec3& pivot : {Vec3(0, 0, 0), Vec3(0.1, 0.2, 0.3)}) {
    for (const Vec3& rotation : {Vec3(20, -40, 0), Vec3(0, 70, 0), Vec3(-120, 0, 0), Vec3(10, 90, 0)}) {
      CAPTURE(pivot.transpose());
      CAPTURE(rotation.transpose());
      Arm arm;
      arm.fore.pre = {20, 0, 30};
      arm.fore.pivot = pivot;
      arm.fore.rotation = rotation;
      check_against_formulas(arm);
    }
  }
}

TEST_CASE("nodes of an FBX file may share a name: joints, and a joint and a mesh") {
  Arm joints, meshes, short_names;
  joints.upper.name = joints.fore.name = "Bone";
  meshes.skin.name = meshes.held.name = "Fore";
  for (Model Arm::*of : {&Arm::skin, &Arm::upper, &Arm::fore, &Arm::held, &Arm::child}) (short_names.*of).name = "b";
  for (const Arm& arm : {joints, meshes, short_names}) {
    Arm own = arm;  // whose nodes are its own parents
    own.fore.parent = &own.upper;
    own.held.parent = &own.fore;
    own.child.parent = &own.held;
    check_against_formulas(own);
  }
}
