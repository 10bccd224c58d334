// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/motion/capture.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include "baker/mesh/error.h"
#include "baker/motion/carried_motion.h"
#include "baker/motion/clip.h"
#include "baker/play/motion_frames.h"
#include "baker/roles/roles.h"
#include "glb_writer.h"
#include "human.h"
#include "rigged_human.h"
#include "temporary_folder.h"

using namespace spherechain::baker;
namespace fs = std::filesystem;

namespace {

constexpr double kOneDegree = std::numbers::pi / 180;

// A joint of a body in a T-pose, in metres: left, up, forward.
struct Part {
  const char *name, *mixamo;
  int parent;
  Vec3 offset, end;  // end: of a bone without a joint at its end, else 0
};
const std::vector<Part>& parts() {
  static const std::vector<Part> all = [] {
    std::vector<Part> out{{"Hips", "mixamorig:Hips", -1, {0, 0, 0}, {0, 0, 0}},
                          {"Ab", "mixamorig:Spine", 0, {0, 0.1, 0}, {0, 0, 0}},
                          {"Chest", "mixamorig:Spine1", 1, {0, 0.2, 0}, {0, 0, 0}},
                          {"Neck", "mixamorig:Neck", 2, {0, 0.2, 0}, {0, 0, 0}},
                          {"Head", "mixamorig:Head", 3, {0, 0.1, 0}, {0, 0.17, 0}}};
    const auto side = [&](std::vector<std::array<const char*, 2>> names, double x) {
      const int arm = static_cast<int>(out.size()), leg = arm + 4;
      out.push_back({names[0][0], names[0][1], 2, {x * 0.02, 0.15, 0}, {0, 0, 0}});
      out.push_back({names[1][0], names[1][1], arm, {x * 0.16, 0, 0}, {0, 0, 0}});
      out.push_back({names[2][0], names[2][1], arm + 1, {x * 0.28, 0, 0}, {0, 0, 0}});
      out.push_back({names[3][0], names[3][1], arm + 2, {x * 0.25, 0, 0}, {x * 0.15, 0, 0}});
      out.push_back({names[4][0], names[4][1], 0, {x * 0.1, 0, 0}, {0, 0, 0}});
      out.push_back({names[5][0], names[5][1], leg, {0, -0.42, 0}, {0, 0, 0}});
      out.push_back({names[6][0], names[6][1], leg + 1, {0, -0.41, 0}, {0, 0, 0}});
      out.push_back({names[7][0], names[7][1], leg + 2, {0, -0.06, 0.15}, {0, 0, 0.08}});
    };
    side({{"LeftCollar", "mixamorig:LeftShoulder"},
          {"LeftShoulder", "mixamorig:LeftArm"},
          {"LeftElbow", "mixamorig:LeftForeArm"},
          {"LeftWrist", "mixamorig:LeftHand"},
          {"LeftHip", "mixamorig:LeftUpLeg"},
          {"LeftKnee", "mixamorig:LeftLeg"},
          {"LeftAnkle", "mixamorig:LeftFoot"},
          {"LeftToes", "mixamorig:LeftToeBase"}},
         1);
    side({{"RightCollar", "mixamorig:RightShoulder"},
          {"RightShoulder", "mixamorig:RightArm"},
          {"RightElbow", "mixamorig:RightForeArm"},
          {"RightWrist", "mixamorig:RightHand"},
          {"RightHip", "mixamorig:RightUpLeg"},
          {"RightKnee", "mixamorig:RightLeg"},
          {"RightAnkle", "mixamorig:RightFoot"},
          {"RightToes", "mixamorig:RightToeBase"}},
         -1);
    return out;
  }();
  return all;
}

// Motion of a joint in a frame: a turn about one of the body's axes (0 left, 1 up, 2 forward).
struct Turn {
  int axis = 0;
  double degrees = 0;
};
struct Frame {
  Vec3 hips = Vec3::Zero();           // metres
  std::map<std::string, Turn> turns;  // by the first of a part's names
};

// How a capture is written down.
struct Style {
  double unit = 1;                                      // a metre
  Eigen::Matrix3d rest = Eigen::Matrix3d::Identity();   // the body's axes -> those its skeleton rests in
  Eigen::Matrix3d space = Eigen::Matrix3d::Identity();  // the body's axes -> those it moves in
  bool mixamo = false;
};

// Angles about z, x and y, in that order: R = Rz Rx Ry.
Vec3 zxy(const Eigen::Matrix3d& r) { return r.eulerAngles(2, 0, 1) / kOneDegree; }

std::string bvh(const std::vector<Frame>& frames, const Style& style = {}, double frame_time = 0.5) {
  std::ostringstream out;
  out.precision(9);
  const auto row = [](const Vec3& v) {
    std::ostringstream text;
    text.precision(9);
    text << v.x() << ' ' << v.y() << ' ' << v.z();
    return text.str();
  };
  const auto offset = [&](const Vec3& v) { return "OFFSET " + row(style.unit * (style.rest * v)) + "\n"; };
  std::vector<std::size_t> order;  // as the file nests them
  const std::function<void(std::size_t)> write = [&](std::size_t p) {
    const Part& part = parts()[p];
    order.push_back(p);
    out << (part.parent < 0 ? "ROOT " : "JOINT ") << (style.mixamo ? part.mixamo : part.name) << "\n{\n"
        << offset(part.offset)
        << (part.parent < 0 ? "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
                            : "CHANNELS 3 Zrotation Xrotation Yrotation\n");
    for (std::size_t c = 0; c < parts().size(); ++c) {
      if (parts()[c].parent == static_cast<int>(p)) write(c);
    }
    if (!part.end.isZero()) out << "End Site\n{\n" << offset(part.end) << "}\n";
    out << "}\n";
  };
  out << "HIERARCHY\n";
  write(0);
  out << "MOTION\nFrames: " << frames.size() << "\nFrame Time: " << frame_time << "\n";
  for (const Frame& frame : frames) {
    for (const std::size_t p : order) {
      Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
      if (const auto found = frame.turns.find(parts()[p].name); found != frame.turns.end()) {
        turn = Eigen::AngleAxisd(found->second.degrees * kOneDegree, Vec3::Unit(found->second.axis)).toRotationMatrix();
      }
      Eigen::Matrix3d local = style.rest * turn * style.rest.transpose();
      if (p == 0) {
        out << row(style.unit * (style.space * frame.hips)) << ' ';
        local = style.space * turn * style.rest.transpose();
      }
      out << row(zxy(local)) << ' ';
    }
    out << '\n';
  }
  return out.str();
}

std::vector<Affine> posed_file(const fs::path& file, double t) {
  const RiggedHuman& h = rigged_human();
  return CaptureMotion(read_capture(file), body_of(h.joints, h.frame, "human")).at(t).bones;
}
std::vector<Affine> posed(const std::vector<Frame>& frames, double t, const Style& style = {}) {
  const TemporaryFolder folder;
  return posed_file(folder.write("capture.bvh", bvh(frames, style)), t);
}

Eigen::Matrix3d body_axes() {
  Eigen::Matrix3d axes;
  axes << rigged_human().frame.left, rigged_human().frame.up, rigged_human().frame.forward;
  return axes;
}

// In the body's axes.
Vec3 bone(const std::vector<Affine>& bones, const std::string& name) {
  const RiggedHuman& h = rigged_human();
  const std::size_t j = h.joint(name);
  return body_axes().transpose() * (bones[j].linear() * (h.joints[j].tail - h.joints[j].position)).normalized();
}
Eigen::Matrix3d turn_between(const std::vector<Affine>& from, const std::vector<Affine>& to, const std::string& name) {
  const std::size_t j = rigged_human().joint(name);
  return body_axes().transpose() * to[j].linear() * from[j].linear().transpose() * body_axes();
}

// As a fraction of the height, over all joints' ends.
double farthest(const std::vector<Affine>& a, const std::vector<Affine>& b) {
  const RiggedHuman& h = rigged_human();
  double most = 0;
  for (std::size_t j = 0; j < h.joints.size(); ++j) {
    for (const Vec3& p : {h.joints[j].position, h.joints[j].tail}) most = std::max(most, (a[j] * p - b[j] * p).norm());
  }
  return most / h.frame.height;
}

double degrees_between(const Vec3& a, const Vec3& b) { return std::atan2(a.cross(b).norm(), a.dot(b)) / kOneDegree; }

constexpr double kSingles = 1e-3;  // degrees: what a file's numbers are read as

const std::vector<Frame>& boxing() {
  static const std::vector<Frame> frames{{{0, 1, 0}, {}},
                                         {{0.1, 0.9, 0.3},
                                          {{"Hips", {1, 30}},
                                           {"Chest", {0, 20}},
                                           {"LeftShoulder", {1, -70}},
                                           {"LeftElbow", {1, -60}},
                                           {"RightShoulder", {2, 50}},
                                           {"LeftHip", {0, -40}},
                                           {"LeftKnee", {0, 60}},
                                           {"Head", {1, -15}}}},
                                         {{0.3, 1.1, 0.5}, {{"RightHip", {2, -20}}, {"RightElbow", {1, 80}}}}};
  return frames;
}

}  // namespace

TEST_CASE("where a capture rests, our limbs are parallel to its own and the trunk stays as it is" *
          doctest::test_suite("long runs")) {
  const std::vector<Affine> bones = posed({{{0, 1, 0}, {}}}, 0);
  for (const char* name : {"left_shoulder", "left_elbow", "left_wrist"})
    CHECK(degrees_between(bone(bones, name), Vec3(1, 0, 0)) < kSingles);
  for (const char* name : {"right_shoulder", "right_elbow", "right_wrist"})
    CHECK(degrees_between(bone(bones, name), Vec3(-1, 0, 0)) < kSingles);
  for (const char* name : {"left_hip", "left_knee", "right_hip", "right_knee"})
    CHECK(degrees_between(bone(bones, name), Vec3(0, -1, 0)) < kSingles);
  for (const char* name : {"pelvis", "spine", "chest", "neck", "head", "left_clavicle"})
    CHECK(bones[rigged_human().joint(name)].linear().isIdentity(1e-6));
  // Soles stay level, and a hand's back up: arms in a T-pose show their palms to the floor.
  for (const char* name : {"left_ankle", "right_ankle"})
    CHECK(
        (bones[rigged_human().joint(name)].linear() * rigged_human().frame.up).isApprox(rigged_human().frame.up, 1e-6));
}

TEST_CASE("a joint that turns in a capture turns ours by the same angle about the same axis of the body" *
          doctest::test_suite("many bakes")) {
  const std::map<std::string, std::string> ours{{"Hips", "pelvis"},
                                                {"Ab", "spine"},
                                                {"Chest", "chest"},
                                                {"Neck", "neck"},
                                                {"Head", "head"},
                                                {"LeftElbow", "left_elbow"},
                                                {"RightShoulder", "right_shoulder"},
                                                {"RightWrist", "right_wrist"},
                                                {"LeftHip", "left_hip"},
                                                {"RightKnee", "right_knee"},
                                                {"LeftAnkle", "left_ankle"},
                                                {"LeftCollar", "left_clavicle"}};
  const std::vector<Affine> rest = posed({{{0, 1, 0}, {}}, {{0, 1, 0}, {}}}, 0);
  for (const auto& [theirs, role] : ours) {
    // Both axes of the trunk, and one of each other joint in turn.
    const bool is_limb = role.starts_with("left_") || role.starts_with("right_");
    for (const int axis : {0, 2}) {
      if (is_limb && axis == (role.size() % 2 == 0 ? 0 : 2)) continue;
      CAPTURE(theirs);
      const std::vector<Frame> frames{{{0, 1, 0}, {}}, {{0, 1, 0}, {{theirs, {axis, 40}}}}};
      const std::vector<Affine> turned = posed(frames, 1);
      const Eigen::Matrix3d expected = Eigen::AngleAxisd(40 * kOneDegree, Vec3::Unit(axis)).toRotationMatrix();
      CHECK(turn_between(rest, turned, role).isApprox(expected, 1e-5));
      const char* other = role[0] == 'l' ? "right_elbow" : "left_knee";
      if (is_limb) CHECK(turn_between(rest, turned, other).isIdentity(1e-5));
    }
  }
}

TEST_CASE("left is left: a capture mirrored is played mirrored") {
  const auto arm_up = [](const std::string& side, double degrees) {
    return posed({{{0, 1, 0}, {}}, {{0, 1, 0}, {{side + "Shoulder", {2, degrees}}, {side + "Knee", {0, 50}}}}}, 1);
  };
  const std::vector<Affine> left = arm_up("Left", 70), right = arm_up("Right", -70);
  CHECK(bone(left, "left_elbow").y() > 0.9);
  for (const std::string role : {"shoulder", "elbow", "wrist", "knee"}) {
    const Vec3 mirrored = bone(right, "right_" + role).cwiseProduct(Vec3(-1, 1, 1));
    CHECK(degrees_between(bone(left, "left_" + role), mirrored) < kSingles);
  }
}

TEST_CASE("units, axes, heading and names of a capture change nothing" * doctest::test_suite("long runs")) {
  Eigen::Matrix3d z_up, sideways;
  z_up << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  sideways << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  Style inches, mixamo, rests_z_up, all_z_up, turned, heads_sideways;
  inches.unit = 39.37;
  mixamo.mixamo = true;
  all_z_up.rest = all_z_up.space = rests_z_up.rest = z_up;
  turned.rest = turned.space = heads_sideways.space = sideways;
  for (const double t : {0.0, 0.5, 1.0}) {
    const std::vector<Affine> plain = posed(boxing(), t);
    for (const Style& style : {inches, mixamo, rests_z_up, all_z_up, turned, heads_sideways})
      CHECK(farthest(plain, posed(boxing(), t, style)) < 1e-5);  // singles
  }
  CHECK(farthest(posed(boxing(), 0), posed(boxing(), 0.5)) > 0.2);
}

TEST_CASE("the pelvis travels in proportion to the legs, and the feet stand where they rest") {
  const RiggedHuman& h = rigged_human();
  const auto at = [&](const char* name) { return h.joints[h.joint(name)].position; };
  const double ours =
      0.5 * ((at("left_hip") - at("left_knee")).norm() + (at("left_knee") - at("left_ankle")).norm() +
             (at("right_hip") - at("right_knee")).norm() + (at("right_knee") - at("right_ankle")).norm());
  // Standing, but for a leap at the end: half a leg left, a whole one up, two forward.
  std::vector<Frame> frames(20, {{0, 1, 0}, {}});
  frames.push_back({{0.415, 1.83, 1.66}, {}});
  const std::vector<Affine> start = posed(frames, 0), end = posed(frames, 1);
  const Vec3 travelled = body_axes().transpose() * (end[0].translation() - start[0].translation());
  CHECK(travelled.isApprox(ours * Vec3(0.5, 1, 2), 1e-5));
  double lowest = 1;
  for (const char* ankle : {"left_ankle", "right_ankle"}) {
    const Joint& foot = h.joints[h.joint(ankle)];
    for (const Vec3& p : {foot.position, foot.tail})
      lowest = std::min(lowest, (start[h.joint(ankle)] * p - p).dot(h.frame.up) / h.frame.height);
  }
  CHECK(std::abs(lowest) < 1e-6);
}

TEST_CASE("a skeleton that rests as nobody stands is compared where somebody does") {
  // Legs that rest straight up; every frame turns them down.
  std::string text = bvh({{{0, 1, 0}, {{"LeftHip", {2, 180}}, {"RightHip", {2, 180}}}}});
  for (const char* down : {"OFFSET 0 -0.42 0", "OFFSET 0 -0.41 0"}) {
    for (auto at = text.find(down); at != std::string::npos; at = text.find(down)) text.erase(at + 9, 1);
  }
  const TemporaryFolder folder;
  CHECK(farthest(posed_file(folder.write("folded.bvh", text), 0), posed({{{0, 1, 0}, {}}}, 0)) < 0.05);
}

TEST_CASE("the limbs of a recorded boxer go where his own go, and no foot sinks in") {
  const RiggedHuman& h = rigged_human();
  const Capture capture = read_capture(kModels / "BVH/Boxing_Toes.bvh");
  const CaptureMotion motion(capture, body_of(h.joints, h.frame, "human"));
  CHECK(motion.duration() == doctest::Approx(30.69));
  const auto node = [&](const std::string& name) {
    const auto& nodes = capture.rig.nodes;
    return static_cast<std::size_t>(
        std::find_if(nodes.begin(), nodes.end(), [&](const Node& n) { return n.name == name; }) - nodes.begin());
  };
  const auto own_axes = [&](const std::vector<Affine>& world) {  // y is up in the file
    const Vec3 left = world[node("LeftHip")].translation() - world[node("RightHip")].translation();
    Eigen::Matrix3d axes;
    axes.col(0) = Vec3(left.x(), 0, left.z()).normalized();
    axes.col(1) = Vec3::UnitY();
    axes.col(2) = axes.col(0).cross(axes.col(1));
    return axes;
  };
  const Eigen::Matrix3d axes = own_axes(world_at(capture.rig, capture.clip, 0));
  const std::vector<std::array<std::string, 3>> limbs{{"shoulder", "Shoulder", "Elbow"},
                                                      {"elbow", "Elbow", "Wrist"},
                                                      {"hip", "Hip", "Knee"},
                                                      {"knee", "Knee", "Ankle"}};
  for (int i = 0; i <= 40; ++i) {
    const double t = i / 40.0;
    const std::vector<Affine> world = world_at(capture.rig, capture.clip, t * motion.duration());
    const std::vector<Affine> bones = motion.at(t).bones;
    for (const auto& [ours, from, to] : limbs) {
      for (const auto& [side, theirs] : {std::pair{"left_", "Left"}, std::pair{"right_", "Right"}}) {
        const Vec3 direction = world[node(theirs + to)].translation() - world[node(theirs + from)].translation();
        CHECK(degrees_between(bone(bones, side + ours), axes.transpose() * direction) < 0.1);
      }
    }
    for (const char* ankle : {"left_ankle", "right_ankle"}) {
      const Vec3& p = h.joints[h.joint(ankle)].position;
      CHECK((bones[h.joint(ankle)] * p - p).dot(h.frame.up) > -0.03 * h.frame.height);
    }
  }
}

TEST_CASE("a character with a skin of its own is moved by the roles of its bones") {
  const Character character = import_character(kModels / "X/BCN_Epileptic.X");
  BodyFrame frame{Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ(), 1.8};
  const CaptureBody body = body_of(character.rig, character.source_positions, frame, "x");
  REQUIRE(body.joint_of_bone.size() == character.rig.bones.size());
  const TemporaryFolder folder;
  const std::vector<Frame> frames{{{0, 1, 0}, {}}, {{0, 1, 0}, {{"LeftShoulder", {2, 90}}, {"RightElbow", {1, 90}}}}};
  const CaptureMotion motion(read_capture(folder.write("up.bvh", bvh(frames))), body);
  const auto direction = [&](const std::vector<Affine>& bones, const char* role) {
    const Joint& joint = body.joints.joints[static_cast<std::size_t>(body.joints.find(role))];
    for (std::size_t b = 0; b < bones.size(); ++b) {
      if (body.joint_of_bone[b] == static_cast<Index>(body.joints.find(role)))
        return Vec3(bones[b].linear() * (joint.tail - joint.position));
    }
    return Vec3(0, 0, 0);
  };
  const std::vector<Affine> rest = motion.at(0).bones, up = motion.at(1).bones;
  CHECK(degrees_between(direction(rest, "left_elbow"), Vec3(1, 0, 0)) < kSingles);
  CHECK(degrees_between(direction(up, "left_elbow"), Vec3(0, 1, 0)) < kSingles);
  CHECK(degrees_between(direction(up, "right_shoulder"), Vec3(-1, 0, 0)) < kSingles);
  CHECK(degrees_between(direction(up, "right_elbow"), Vec3(0, 0, 1)) < kSingles);
  // Fingers go with the hand.
  for (std::size_t b = 0; b < up.size(); ++b) {
    if (character.rig.nodes[character.rig.bones[b].node].name.find("Finger1_Left") == std::string::npos) continue;
    CHECK(body.joints.joints[body.joint_of_bone[b]].name == "left_wrist");
  }
}

TEST_CASE("a motion of the character's very skeleton is played by the names of its nodes, not by roles") {
  const fs::path file = kModels / "X/Testwuson.X";  // no biped
  const Character wuson = import_character(file);
  const auto motion = carried_motion(file, wuson.rig, wuson.source_positions, BodyFrame(), "wuson");
  const ClipMotion own(wuson.rig, {&wuson.rig.clips[1]});  // Walk, the longest
  CHECK(motion->duration() == own.duration());
  for (const double t : {0.0, 0.4, 1.0}) {
    const std::vector<Affine> a = motion->at(t).bones, b = own.at(t).bones;
    for (std::size_t i = 0; i < a.size(); ++i) CHECK(a[i].isApprox(b[i], 1e-9));
  }
  CHECK_THROWS_WITH_AS(
      carried_motion(kModels / "BVH/01_03.bvh", wuson.rig, wuson.source_positions, BodyFrame(), "wuson.X"),
      doctest::Contains("wuson.X: its skeleton is not that of a biped"), Error);
}

TEST_CASE("a recording on a character's own joints is played though a bone of it is longer, and keeps its length") {
  const fs::path file = kModels / "X/Testwuson.X";
  const Character wuson = import_character(file);
  SourceRig longer = wuson.rig;
  Index bone = 0;  // that hangs on another
  for (const Bone& one : wuson.rig.bones) {
    const int parent = wuson.rig.nodes[one.node].parent;
    const bool hangs = std::any_of(wuson.rig.bones.begin(), wuson.rig.bones.end(),
                                   [&](const Bone& other) { return static_cast<int>(other.node) == parent; });
    if (hangs && wuson.rig.nodes[one.node].translation.norm() > 0) bone = one.node;
  }
  REQUIRE(bone > 0);
  Node& node = longer.nodes[bone];
  node.translation *= 1.5;
  node.local.translation() *= 1.5;
  const auto motion = carried_motion(file, longer, wuson.source_positions, BodyFrame(), "wuson");
  const auto length_of = [&](const SourceRig& rig, const Clip& clip) {
    const std::vector<Affine> world = world_at(rig, clip, 0.4);
    return (world[bone].translation() - world[static_cast<std::size_t>(node.parent)].translation()).norm();
  };
  CHECK(length_of(longer, motion->clip()) == doctest::Approx(1.5 * length_of(wuson.rig, wuson.rig.clips[1])));
}

TEST_CASE("a recording whose joints have other axes is not played by their names") {
  // As BVH has it: every joint's axes are those of the space.
  const fs::path file = kModels / "X/Testwuson.X";
  const Character wuson = import_character(file);
  SourceRig plain = wuson.rig;
  const std::vector<Vec3> places = rest_positions(wuson.rig);
  for (std::size_t n = 0; n < plain.nodes.size(); ++n) {
    Node& node = plain.nodes[n];
    node.rotation.setIdentity();
    node.translation =
        places[n] - (node.parent < 0 ? Vec3(Vec3::Zero()) : places[static_cast<std::size_t>(node.parent)]);
    node.local = Affine(Eigen::Translation3d(node.translation));
  }
  CHECK_THROWS_WITH_AS(carried_motion(file, plain, wuson.source_positions, BodyFrame(), "wuson"),
                       doctest::Contains("is not that of a biped"), Error);
}

TEST_CASE("a bone without a key is in a recording as its file has it at rest") {
  SourceRig rig;
  rig.nodes.resize(3);
  Glb glb;
  glb.json["nodes"] = nlohmann::json::array();
  for (std::size_t n = 0; n < 3; ++n) {
    rig.nodes[n].name = "bone " + std::to_string(n);
    rig.nodes[n].parent = static_cast<int>(n) - 1;
    rig.nodes[n].translation = rig.nodes[n].local.translation() = Vec3(0, 1, 0);
    rig.bones.push_back({static_cast<Index>(n), Affine::Identity()});
    nlohmann::json node{{"name", rig.nodes[n].name}, {"translation", {0, 100, 0}}};
    if (n < 2) node["children"] = {n + 1};
    if (n == 1) node["rotation"] = {1, 0, 0, 0};  // half a turn
    glb.json["nodes"].push_back(node);
  }
  const int times = glb.accessor(std::vector<float>{0, 1}, "SCALAR"),
            moves = glb.accessor(std::vector<float>{0, 100, 0, 0, 300, 0}, "VEC3");
  glb.json["animations"] = {{{"samplers", {{{"input", times}, {"output", moves}}}},
                             {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
  const TemporaryFolder folder;
  const auto motion = carried_motion(folder.write("arm.glb", glb.bytes()), rig, {}, BodyFrame(), "arm");
  const std::vector<Affine> end = motion->at(1).bones;
  CHECK(end[0].translation().isApprox(Vec3(0, 3, 0)));
  CHECK(end[1].translation().isApprox(Vec3(0, 4, 0)));
  CHECK(end[2].translation().isApprox(Vec3(0, 3, 0)));
}

TEST_CASE("a recording of one pose is one frame") {
  const RiggedHuman& h = rigged_human();
  const TemporaryFolder folder;
  const CaptureMotion pose(read_capture(folder.write("pose.bvh", bvh({{{0, 1, 0}, {}}}))),
                           body_of(h.joints, h.frame, "human"));
  CHECK(frames_of(&pose, {}).frames.size() == 1);
  CHECK(frames_of(&pose, {0, 0}).frames.size() == 1);
  const CaptureMotion three(read_capture(folder.write("three.bvh", bvh(boxing(), {}, 0.033333))),
                            body_of(h.joints, h.frame, "human"));
  for (const double fps : {0.0, 30.0}) CHECK(frames_of(&three, {0, fps}).frames.size() == 3);
}

TEST_CASE("a body that no recording can move is refused by what it lacks") {
  const RiggedHuman& h = rigged_human();
  CHECK_THROWS_WITH_AS(body_of({}, h.frame, "boxes.glb"),
                       doctest::Contains("boxes.glb: its body has no pelvis, left hip, right hip, left knee"), Error);
  for (const char* role : {"left_hip", "right_ankle"}) {
    std::vector<Joint> joints = h.joints;
    joints[h.joint(role)].name = "tentacle";
    std::string words = role;
    words.replace(words.find('_'), 1, " ");
    CHECK_THROWS_WITH_AS(body_of(joints, h.frame, "squid.glb"),
                         doctest::Contains(("squid.glb: its body has no " + words + " (").c_str()), Error);
  }
}

TEST_CASE("a capture that is broken is refused with the file's name and the cause") {
  const TemporaryFolder folder;
  const std::string good = bvh(boxing());
  const auto refusal = [&](const std::string& text) {
    const fs::path file = folder.write("broken.bvh", text);
    try {
      const RiggedHuman& h = rigged_human();
      CaptureMotion(read_capture(file), body_of(h.joints, h.frame, "human")).at(0.5);
    } catch (const Error& error) {
      CHECK(error.code() == ExitCode::kFile);
      const std::string what = error.what();
      CHECK(what.rfind(file.string() + ": ", 0) == 0);
      return what;
    }
    return std::string("accepted");
  };
  const auto says = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    REQUIRE(text.find(from) != std::string::npos);
    return text.replace(text.find(from), from.size(), to);
  };
  CHECK(refusal(good) == "accepted");
  for (const std::size_t length : {0U, 5U, 40U, 300U, 900U}) CHECK(refusal(good.substr(0, length)) != "accepted");
  CHECK(says(refusal(good.substr(0, good.size() - 20)), "cut off"));
  CHECK(says(refusal(good.substr(0, good.find("MOTION"))), "ends before its motion"));
  for (const char* time : {"0", "0.0", "-0.5", "nan", "inf", "1e30", "soon"}) {
    CAPTURE(time);
    CHECK(says(refusal(changed("Frame Time: 0.5", std::string("Frame Time: ") + time)),
               (std::string("frame time of '") + time + "'").c_str()));
  }
  CHECK(says(refusal(changed("Frame Time: 0.5", "")), "where the frame time is expected"));
  CHECK(says(refusal(changed("OFFSET 0.28 0 0", "OFFSET nan 0 0")), "'nan' where OFFSET's x is expected"));
  CHECK(says(refusal(changed("Frame Time: 0.5\n0 ", "Frame Time: 0.5\ninf ")), "'inf' in frame 0 is no number"));
  CHECK(says(refusal(changed("CHANNELS 6 Xposition", "CHANNELS 6 Wposition")), "channel"));
  std::string deep = "HIERARCHY\nROOT a\n{\n";
  for (int i = 0; i < 100000; ++i) deep += "JOINT b { OFFSET 0 0 0\n";
  CHECK(says(refusal(deep), "within each other"));
  std::string late = "HIERARCHY\nROOT a\n{\nJOINT b\n{\nOFFSET 0 0 0\n}\nCHANNELS 1 Xrotation\n}\nMOTION\nFrames: 1\n";
  CHECK(says(refusal(late), "after its children"));
  CHECK(says(refusal("HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n"
                     "MOTION\nFrames: 1\nFrame Time: 1\n0\n"),
             "cannot be recognised"));
}
