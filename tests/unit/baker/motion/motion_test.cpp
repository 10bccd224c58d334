// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/motion/poses.h"

#include <doctest/doctest.h>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include "baker/mesh/error.h"
#include "baker/mesh/surface_query.h"
#include "rigged_human.h"

using namespace spherechain::baker;
namespace fs = std::filesystem;

namespace {

const fs::path kPoses = fs::path(SPHERECHAIN_SAMPLES) / "poses";
constexpr int kFrames = 40;  // as in the paper's section 5.1

std::vector<Vec3> body_at(const PoseMotion& motion, double t) {
  const RiggedHuman& h = rigged_human();
  return deform(h.body.positions, h.weights, BezierMotion(h.joints, h.frame, motion).at(t).bones);
}

// A folder of pose files that is gone at the end.
class PoseFolder {
 public:
  PoseFolder() : path_(fs::temp_directory_path() / ("spherechain_poses_" + std::to_string(std::rand()))) {
    fs::create_directories(path_);
  }
  ~PoseFolder() { fs::remove_all(path_); }
  PoseFolder(const PoseFolder&) = delete;
  PoseFolder& operator=(const PoseFolder&) = delete;
  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
    return path_ / name;
  }

 private:
  fs::path path_;
};

// The error message for a pose file. Empty if it can be read.
std::string complaint(const fs::path& file) {
  try {
    read_pose_motion(file, rigged_human().joints);
  } catch (const Error& error) {
    CHECK(error.code() == ExitCode::kFile);
    const std::string what = error.what();
    CHECK(what.find('\n') == std::string::npos);
    return what;
  }
  return "";
}

bool says(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

// The region of every vertex; the part of a limb that is away from the torso is its own.
std::vector<Index> distal_vertices(std::uint8_t region) {
  const RiggedHuman& h = rigged_human();
  const std::string side = region % 2 == 0 ? "left_" : "right_";
  const std::size_t upper = h.joint(side + (region < 2 ? "elbow" : "hip"));
  const std::size_t lower = h.joint(side + (region < 2 ? "wrist" : "knee"));
  std::vector<Index> vertices;
  for (Index v = 0; v < h.weights.size(); ++v) {
    double sum = 0;
    for (std::size_t k = 0; k < kMaxInfluences; ++k) {
      const Index joint = h.weights[v].joint[k];
      if (joint == upper || joint == lower) sum += h.weights[v].weight[k];
    }
    if (sum > (region < 2 ? 0.5 : 0.9)) vertices.push_back(v);
  }
  return vertices;
}

// 1 inside, 0 outside, between near the region's open ends. In plain numbers, because tests are not optimised.
double winding_number(const Mesh& mesh, const std::vector<Index>& triangles, const Vec3& p) {
  double angle = 0;
  for (const Index t : triangles) {
    double to[3][3], far[3], cosines[3];
    for (int i = 0; i < 3; ++i) {
      const double* corner = mesh.positions[mesh.triangles[t][static_cast<std::size_t>(i)]].data();
      for (int k = 0; k < 3; ++k) to[i][k] = corner[k] - p.data()[k];
      far[i] = std::sqrt(to[i][0] * to[i][0] + to[i][1] * to[i][1] + to[i][2] * to[i][2]);
    }
    const auto &a = to[0], &b = to[1], &c = to[2];
    for (int i = 0; i < 3; ++i) {
      const auto &from = to[i], &next = to[(i + 1) % 3];
      cosines[i] = from[0] * next[0] + from[1] * next[1] + from[2] * next[2];
    }
    const double volume =
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    angle += 2 * std::atan2(volume,
                            far[0] * far[1] * far[2] + cosines[0] * far[2] + cosines[1] * far[0] + cosines[2] * far[1]);
  }
  return angle / (4 * std::numbers::pi);
}

// How deep a limb's vertices are inside another region, as a fraction of the height; 0 where none is.
double depth(const Mesh& posed, std::uint8_t limb, std::uint8_t region) {
  const RiggedHuman& h = rigged_human();
  std::vector<Index> triangles;
  for (Index t = 0; t < posed.triangles.size(); ++t) {
    if (human().regions.of_triangle[t] == region) triangles.push_back(t);
  }
  const SurfaceQuery surface(posed, triangles);
  std::vector<std::pair<double, Index>> behind;
  for (const Index v : distal_vertices(limb)) {
    const Vec3& p = posed.positions[v];
    const SurfaceHit hit = surface.closest(p);
    if ((p - hit.point).dot(triangle_cross(posed, hit.triangle)) < 0) behind.emplace_back(hit.distance, v);
  }
  // The deepest first, because a winding number takes long.
  std::sort(behind.rbegin(), behind.rend());
  for (const auto& [distance, v] : behind) {
    if (winding_number(posed, triangles, posed.positions[v]) > 0.5) return distance / h.frame.height;
  }
  return 0;
}

}  // namespace

TEST_CASE("skinning with a pose that turns nothing is exactly the identity") {
  const RiggedHuman& h = rigged_human();
  CHECK(h.posed({}) == h.body.positions);
  Pose still;
  for (const Joint& joint : h.joints) still.rotations[joint.name] = Eigen::Quaterniond::Identity();
  CHECK(h.posed(still) == h.body.positions);
}

TEST_CASE("a turned root turns the whole body rigidly, about the character's own axes") {
  const RiggedHuman& h = rigged_human();
  const std::vector<Vec3> posed = h.posed(turn("pelvis", 90, {0, 1, 0}));
  const Vec3 pivot = h.own_axes(h.joints[0].position);
  for (std::size_t v = 0; v < posed.size(); ++v) {
    // A quarter turn about up takes forward to left.
    const Vec3 rest = h.own_axes(h.body.positions[v]) - pivot, now = h.own_axes(posed[v]) - pivot;
    REQUIRE((now - Vec3(rest.z(), rest.y(), -rest.x())).norm() < 1e-9);
  }
}

TEST_CASE("frame 0 of a motion is rest and the last frame the last pose, exactly") {
  const RiggedHuman& h = rigged_human();
  for (const char* file : {"animation_arms.json", "animation_legs.json"}) {
    const PoseMotion motion = read_pose_motion(kPoses / file, h.joints);
    CHECK(body_at(motion, 0) == h.body.positions);
    CHECK(body_at(motion, 1) == h.posed(motion.poses.back()));
  }
}

TEST_CASE("a motion passes through each of its poses, evenly spaced") {
  const RiggedHuman& h = rigged_human();
  const PoseMotion motion = read_pose_motion(kPoses / "animation_legs.json", h.joints);
  REQUIRE(motion.poses.size() == 2);
  const std::vector<Vec3> half = body_at(motion, 0.5), pose = h.posed(motion.poses[0]);
  for (std::size_t v = 0; v < pose.size(); ++v) REQUIRE((half[v] - pose[v]).norm() < 1e-12 * h.frame.height);
}

TEST_CASE("no bone changes its length by more than 5 % in any frame of the sample motions") {
  const RiggedHuman& h = rigged_human();
  std::vector<Vec3> ends;
  std::vector<VertexWeights> rigid;
  for (Index j = 0; j < h.joints.size(); ++j) {
    ends.insert(ends.end(), {h.joints[j].position, h.joints[j].tail});
    rigid.insert(rigid.end(), 2, VertexWeights{{j}, {1.0}});
  }
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(kPoses)) {
    if (entry.path().extension() != ".json") continue;
    ++files;
    const BezierMotion motion(h.joints, h.frame, read_pose_motion(entry.path(), h.joints));
    for (int frame = 0; frame < kFrames; ++frame) {
      const std::vector<Vec3> now = deform(ends, rigid, motion.at(static_cast<double>(frame) / (kFrames - 1)).bones);
      for (std::size_t j = 0; j < h.joints.size(); ++j) {
        INFO(entry.path().filename().string() << ", frame " << frame << ", " << h.joints[j].name);
        const double length = (ends[2 * j + 1] - ends[2 * j]).norm();
        REQUIRE(std::abs((now[2 * j + 1] - now[2 * j]).norm() - length) <= 0.05 * length);
      }
    }
  }
  CHECK(files >= 7);
}

TEST_CASE("the sample poses touch where they say, and skin goes no deeper than 2 % of the height into skin") {
  struct Contact {
    const char* file;
    std::uint8_t limb, region;
  };
  constexpr std::uint8_t kLeftArm = 0, kRightArm = 1, kLeftLeg = 2, kRightLeg = 3;
  const Contact contacts[] = {
      {"hands_on_hips.json", kLeftArm, kTorso},    {"hands_on_hips.json", kRightArm, kTorso},
      {"arms_crossed.json", kLeftArm, kTorso},     {"arms_crossed.json", kRightArm, kLeftArm},
      {"hand_behind_head.json", kLeftArm, kTorso}, {"leg_over_leg.json", kLeftLeg, kRightLeg},
      {"deep_squat.json", kLeftArm, kLeftLeg},     {"deep_squat.json", kRightArm, kRightLeg},
  };
  const RiggedHuman& h = rigged_human();
  for (const Contact& contact : contacts) {
    INFO(contact.file << ": " << kRegionNames[contact.limb] << " and " << kRegionNames[contact.region]);
    CHECK(depth(h.body, contact.limb, contact.region) == 0);
    Mesh posed = h.body;
    posed.positions = h.posed(read_pose_motion(kPoses / contact.file, h.joints).poses.back());
    const double deep = depth(posed, contact.limb, contact.region);
    CHECK(deep > 0.001);
    CHECK(deep < 0.02);
  }
}

TEST_CASE("a pose file can take the poses of a neighbour") {
  const PoseFolder folder;
  folder.write("one.json", R"({"name": "one", "poses": [{"neck": [0, 30, 0]}, {"neck": [0, -30, 0]}]})");
  const fs::path two = folder.write("two.json", R"({"poses": ["one.json", {"head": [0, 0, 20]}, "one.json"]})");
  const PoseMotion motion = read_pose_motion(two, rigged_human().joints);
  CHECK(motion.name == "two");
  REQUIRE(motion.poses.size() == 5);
  CHECK(motion.poses[0].rotations.at("neck").isApprox(
      Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 6, Vec3::UnitY()))));
  CHECK(motion.poses[2].rotations.contains("head"));
}

TEST_CASE("a wrong pose file is refused with its name, the cause and what to do") {
  const PoseFolder folder;
  const auto with = [&](const std::string& text) { return complaint(folder.write("wrong.json", text)); };
  CHECK(says(complaint("nowhere/pose.json"), "nowhere/pose.json: no such pose file"));
  CHECK(says(complaint(kPoses), "no such pose file"));
  CHECK(says(with("{\n  \"poses\": [\n    {\"neck\": [1, 2,]}\n]}"), "wrong.json: is not valid JSON: line 3"));
  CHECK(says(with(""), "is not valid JSON"));
  CHECK(says(with("[]"), "is no pose file"));
  CHECK(says(with(R"({"poses": []})"), "is no pose file"));
  CHECK(says(with(R"({"poses": [{}], "speed": 2})"), "the key 'speed' is not known"));
  CHECK(says(with(R"({"poses": [{}], "name": 2})"), "'name' is not a text"));
  CHECK(says(with(R"({"poses": [7]})"), "neither an object of rotations nor the name"));
  const std::string unknown = with(R"({"poses": [{"left_ellbow": [0, 0, 0]}]})");
  CHECK(says(unknown, "there is no joint 'left_ellbow'"));
  CHECK(says(unknown, "left_shoulder, left_elbow, left_wrist"));
}

TEST_CASE("a rotation that is not three finite numbers of at most 180 degrees is refused") {
  const PoseFolder folder;
  for (const char* value : {"[1, 2]", "[1, 2, 3, 4]", "5", "\"left\"", "[1, 2, null]", "[1, 2, \"3\"]", "{}"}) {
    INFO(value);
    const fs::path file = folder.write("wrong.json", std::string(R"({"poses": [{"neck": )") + value + "}]}");
    CHECK(says(complaint(file), "the rotation of 'neck' is not three numbers"));
  }
  for (const char* value : {"[0, 181, 0]", "[1e200, 1e200, 0]"}) {
    INFO(value);
    const fs::path file = folder.write("wrong.json", std::string(R"({"poses": [{"neck": )") + value + "}]}");
    CHECK(says(complaint(file), "more than 180 degrees"));
  }
  // No number at all to JSON: not finite.
  for (const char* value : {"[1e999, 0, 0]", "[NaN, 0, 0]"}) {
    INFO(value);
    const fs::path file = folder.write("wrong.json", std::string(R"({"poses": [{"neck": )") + value + "}]}");
    CHECK(says(complaint(file), "is not valid JSON"));
  }
}

TEST_CASE("pose files that include themselves or what is not there are refused") {
  const PoseFolder folder;
  CHECK(says(complaint(folder.write("self.json", R"({"poses": ["self.json"]})")), "includes itself"));
  folder.write("a.json", R"({"poses": ["b.json"]})");
  CHECK(says(complaint(folder.write("b.json", R"({"poses": ["a.json"]})")), "b.json: includes itself"));
  CHECK(says(complaint(folder.write("c.json", R"({"poses": ["gone.json"]})")), "which is not there"));
  const std::string endless = R"({"poses": [")" + std::string(5000, 'a') + R"("]})";
  CHECK(says(complaint(folder.write("long.json", endless)), "which is not there"));
  // Each file takes the one before it ten times.
  folder.write("d0.json", R"({"poses": [{}]})");
  for (const char digit : {'0', '1', '2', '3', '4'}) {
    std::string text = R"({"poses": [)";
    for (int k = 0; k < 10; ++k) text.append(k > 0 ? ", " : "").append("\"d").append(1, digit).append(".json\"");
    std::string name = "d0.json";
    name[1] = static_cast<char>(digit + 1);
    folder.write(name, text.append("]}"));
  }
  CHECK(says(complaint(folder.write("many.json", R"({"poses": ["d5.json"]})")), "more than 1000 poses"));
}
