// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "baker/mesh/error.h"
#include "baker/motion/poses.h"
#include "rigged_human.h"

using namespace spherechain::baker;
namespace fs = std::filesystem;

namespace {

// A pose file that is gone at the end.
class OwnPoseFile {
 public:
  explicit OwnPoseFile(const std::string& text)
      : path(fs::temp_directory_path() / ("spherechain_own_poses_" + std::to_string(std::rand()) + ".json")) {
    std::ofstream(path) << text;
  }
  ~OwnPoseFile() { fs::remove(path); }
  OwnPoseFile(const OwnPoseFile&) = delete;
  OwnPoseFile& operator=(const OwnPoseFile&) = delete;

  const fs::path path;
};

std::string refusal_of(const std::string& text, const std::vector<Morph>& morphs = {}) {
  const OwnPoseFile file(text);
  try {
    read_pose_motion(file.path, rigged_human().joints, morphs);
  } catch (const Error& error) {
    CHECK(error.code() == ExitCode::kFile);
    return error.what();
  }
  return "";
}

Bone bone_of_leg(Index node, double x) { return {node, Affine(Eigen::Translation3d(-x, 0, 0))}; }

// hip - (a node that moves nothing) - knee - knee: two nodes of one name, and the hip is bound twice. The knee's bone
// is first.
SourceRig bent_leg() {
  SourceRig rig;
  for (const auto& [name, parent] :
       std::vector<std::pair<std::string, int>>{{"hip", -1}, {"between", 0}, {"knee", 1}, {"knee", 2}}) {
    Node node;
    node.name = name;
    node.parent = parent;
    rig.nodes.push_back(node);
  }
  rig.bones = {bone_of_leg(2, 2), bone_of_leg(0, 1), bone_of_leg(3, 3), bone_of_leg(0, 1.5)};
  return rig;
}

}  // namespace

TEST_CASE("a pose file takes poses from its own folder alone") {
  for (const char* out : {"../poses.json", "/tmp/poses.json", "a/../../poses.json", "..\\\\poses.json"}) {
    CHECK_MESSAGE(
        refusal_of("{\"rig\": \"own\", \"poses\": [\"" + std::string(out) + "\"]}").find("poses.json', which is ") !=
            std::string::npos,
        out);
  }
}

TEST_CASE("a long chain of bones of one name takes no time, whatever their order") {
  SourceRig rig;
  constexpr Index kCount = 60000;
  for (Index n = 0; n < kCount; ++n) {
    Node node;
    node.name = "bone";
    node.parent = static_cast<int>(n) - 1;
    rig.nodes.push_back(node);
    rig.bones.push_back({kCount - 1 - n, Affine::Identity()});
  }
  const std::vector<Joint> joints = own_joints(rig);
  REQUIRE(joints.size() == kCount);
  CHECK(joints[0].parent == 1);
  CHECK(joints.back().parent == -1);
  CHECK(joints[1].name == "bone 2");
  CHECK(joints.back().name == "bone 60000");
  const BodyFrame frame{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ(), 1};
  Pose pose;
  pose.movements["bone 60000"] = Affine(Eigen::Translation3d(0, 1, 0));  // the root's
  CHECK((bones_of(joints, frame, pose)[0] * Vec3::Zero()).norm() == doctest::Approx(1));
}

TEST_CASE("a character's own joints are its bones, under names of their own and the nearest joint above") {
  const std::vector<Joint> joints = own_joints(bent_leg());
  REQUIRE(joints.size() == 4);
  const std::vector<std::string> names{"knee", "hip", "knee 2", "hip 2"};
  const std::vector<int> parents{1, -1, 0, 1};
  const std::vector<double> places{2, 1, 3, 1.5};
  for (std::size_t j = 0; j < joints.size(); ++j) {
    CHECK(joints[j].name == names[j]);
    CHECK(joints[j].parent == parents[j]);
    CHECK(joints[j].position.isApprox(Vec3(places[j], 0, 0)));
  }
}

TEST_CASE("a joint takes those below it along, in whatever order they come") {
  const BodyFrame frame{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ(), 2};
  const Pose pose = turn("hip", 90, {0, 1, 0});
  for (const Affine& bone : bones_of(own_joints(bent_leg()), frame, pose)) {
    CHECK((bone * Vec3(3, 0, 0)).isApprox(Vec3(1, 0, -2)));
  }
}

TEST_CASE("twelve numbers move a joint, in heights of the character") {
  const RiggedHuman& h = rigged_human();
  const OwnPoseFile file(R"({"poses": [{"pelvis": [1, 0, 0, 0.25, 0, 1, 0, 0, 0, 0, 1, -0.5]}]})");
  const std::vector<Vec3> moved = h.posed(read_pose_motion(file.path, h.joints).poses.back());
  for (std::size_t v = 0; v < moved.size(); v += 100) {
    REQUIRE((h.own_axes(moved[v]) - h.own_axes(h.body.positions[v]) - Vec3(0.25, 0, -0.5)).norm() < 1e-9);
  }
}

TEST_CASE("a turn written as a matrix is the turn") {
  const RiggedHuman& h = rigged_human();
  const Pose turned = turn("left_elbow", 50, {0.3, -1, 0.2});
  const Vec3 elbow = h.own_axes(h.joints[h.joint("left_elbow")].position);
  Affine movement = Affine::Identity();
  movement.linear() = turned.rotations.at("left_elbow").toRotationMatrix();
  movement.translation() = elbow - movement.linear() * elbow;
  Pose moved;
  moved.movements["left_elbow"] = movement;
  const PoseMotion by_turn{"", {turned}}, by_matrix{"", {moved}};
  for (const double t : {0.3, 1.0}) {  // on the way, too
    const auto one = BezierMotion(h.joints, h.frame, by_turn).at(t).bones;
    const auto two = BezierMotion(h.joints, h.frame, by_matrix).at(t).bones;
    for (std::size_t j = 0; j < one.size(); ++j) CHECK((one[j].matrix() - two[j].matrix()).norm() < 1e-6);
  }
}

TEST_CASE("a pose has weights of morph targets, the others are 0") {
  const std::vector<Morph> morphs{{"smile", {}, {}, 1}, {"blink", {}, {}, 0}};
  const RiggedHuman& h = rigged_human();
  const OwnPoseFile file(R"({"poses": [{"morphs": {"blink": 0.5}}]})");
  const BezierMotion motion(h.joints, h.frame, read_pose_motion(file.path, h.joints, morphs), morphs);
  CHECK(motion.at(1).morphs == std::vector<double>{0, 0.5});
  CHECK(motion.at(0.5).morphs == std::vector<double>{0, 0.25});
  CHECK(refusal_of(R"({"poses": [{"morphs": {"blonk": 1}}]})", morphs)
            .find("no morph target 'blonk' (known: smile, blink)") != std::string::npos);
  CHECK(
      refusal_of(R"({"poses": [{"morphs": {"blink": "1"}}]})", morphs).find("the weight of 'blink' is not a number") !=
      std::string::npos);
}

TEST_CASE("a matrix or a rig that makes no sense is refused") {
  CHECK(refusal_of(R"({"poses": [{"neck": [1, 2, 3, 4, 5, 6]}]})").find("is not three numbers, nor twelve") !=
        std::string::npos);
  CHECK(refusal_of(R"({"poses": [{"neck": [1, 0, 0, 1e300, 0, 1, 0, 0, 0, 0, 1, 0]}]})").find("beyond a million") !=
        std::string::npos);
  CHECK(refusal_of(R"({"rig": "mine", "poses": [{}]})").find("'rig' is neither \"automatic\" nor \"own\"") !=
        std::string::npos);
  const OwnPoseFile own(R"({"rig": "own", "poses": [{}]})");
  CHECK(rig_of_poses(own.path) == PoseRig::kOwn);
  CHECK(refusal_of(R"({"poses": [")" + own.path.filename().string() + R"("]})").find("names joints of another rig") !=
        std::string::npos);
}
