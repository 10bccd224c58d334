// SPDX-License-Identifier: GPL-3.0-or-later
// Motions in the tables of AMASS and its kin, on a body.
#include "baker/import/smpl_motion.h"

#include <doctest/doctest.h>

#include <map>

#include "array_bytes.h"
#include "baker/motion/capture.h"
#include "refusal.h"
#include "rigged_human.h"
#include "temporary_folder.h"

using namespace spherechain::baker;
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kPelvis = 0, kLeftHip = 1, kLeftKnee = 4, kRightKnee = 5, kLeftShoulder = 16, kRightShoulder = 17,
                      kLeftElbow = 18;

// A frame: the axis angles of joints in degrees, x to the left, y up, z forward; and the place in metres.
struct SmplFrame {
  std::map<std::size_t, Vec3> turns;
  Vec3 place = Vec3::Zero();
};
const std::vector<SmplFrame> kSteps{
    {{}, {0, 0.9, 0}},
    {{{kLeftShoulder, {0, 0, 90}}, {kRightShoulder, {0, 40, 0}}, {kLeftKnee, {90, 0, 0}}}, {0, 0.9, 0.5}},
    {{{kPelvis, {0, 30, 0}}, {kLeftHip, {-60, 0, 0}}, {kRightKnee, {20, 0, 0}}, {kLeftElbow, {0, -80, 0}}},
     {0.2, 0.9, 1}}};

Eigen::Quaterniond smpl_turn(const SmplFrame& frame, std::size_t joint) {
  const auto found = frame.turns.find(joint);
  if (found == frame.turns.end()) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(
      Eigen::AngleAxisd(found->second.norm() * std::numbers::pi / 180, found->second.normalized()));
}

// The axis angles of all joints, frame by frame, in a space that `space` turns the body's axes to.
std::vector<double> smpl_angles(const std::vector<SmplFrame>& frames, std::size_t joints,
                                const Eigen::Quaterniond& space = Eigen::Quaterniond::Identity()) {
  std::vector<double> out;
  for (const SmplFrame& frame : frames) {
    for (std::size_t j = 0; j < joints; ++j) {
      const Eigen::AngleAxisd turn(j == kPelvis ? space * smpl_turn(frame, j) : smpl_turn(frame, j));
      const Vec3 vector = turn.angle() * turn.axis();
      out.insert(out.end(), vector.begin(), vector.end());
    }
  }
  return out;
}
std::vector<double> smpl_places(const std::vector<SmplFrame>& frames,
                                const Eigen::Quaterniond& space = Eigen::Quaterniond::Identity()) {
  std::vector<double> out;
  for (const SmplFrame& frame : frames) {
    const Vec3 place = space * frame.place;
    out.insert(out.end(), place.begin(), place.end());
  }
  return out;
}
std::string shape_text(std::size_t rows, std::size_t columns) {
  return "(" + std::to_string(rows) + ", " + std::to_string(columns) + ")";
}

// A file of AMASS of `joints` joints.
std::string amass(const std::vector<SmplFrame>& frames, std::size_t joints = 52,
                  const Eigen::Quaterniond& space = Eigen::Quaterniond::Identity()) {
  return npz({{"poses", npy(smpl_angles(frames, joints, space), shape_text(frames.size(), 3 * joints))},
              {"trans", npy(smpl_places(frames, space), shape_text(frames.size(), 3))},
              {"gender", npy("'<U4'", "()", std::string("m\0\0\0a\0\0\0l\0\0\0e\0\0\0", 16))},
              {"mocap_framerate", npy({25}, "()")}});
}

CaptureMotion on_human(const fs::path& file) {
  const RiggedHuman& h = rigged_human();
  return {read_capture(file), body_of(h.joints, h.frame, "human")};
}

// In the body's axes.
Vec3 smpl_bone(const CaptureMotion& motion, double t, const std::string& name) {
  const RiggedHuman& h = rigged_human();
  const std::size_t j = h.joint(name);
  const Affine moved = motion.joints_at(t)[j];
  return h.own_axes(h.frame.origin +
                    h.frame.height * (moved.linear() * (h.joints[j].tail - h.joints[j].position)).normalized());
}

// The farthest that a joint is in one motion from where it is in the other, in heights, over all frames.
double farthest_between(const CaptureMotion& a, const CaptureMotion& b) {
  const RiggedHuman& h = rigged_human();
  double out = 0;
  for (const double t : {0.0, 0.5, 1.0}) {
    const std::vector<Affine> p = a.joints_at(t), q = b.joints_at(t);
    for (std::size_t j = 0; j < h.joints.size(); ++j)
      out = std::max(out, (p[j] * h.joints[j].tail - q[j] * h.joints[j].tail).norm() / h.frame.height);
  }
  return out;
}

constexpr double kSameJoint = 1e-5;

}  // namespace

TEST_CASE("arms and legs point where SMPL's do: left is left, up is up, and knees bend backwards") {
  const TemporaryFolder folder;
  const CaptureMotion motion = on_human(folder.write("a.npz", amass(kSteps)));
  CHECK(motion.duration() == doctest::Approx(0.08));
  CHECK(motion.rate() == doctest::Approx(25));
  constexpr double kNear = 0.01;
  CHECK((smpl_bone(motion, 0, "left_shoulder") - Vec3(1, 0, 0)).norm() < kNear);
  CHECK((smpl_bone(motion, 0, "right_shoulder") - Vec3(-1, 0, 0)).norm() < kNear);
  CHECK((smpl_bone(motion, 0.5, "left_shoulder") - Vec3(0, 1, 0)).norm() < kNear);
  CHECK((smpl_bone(motion, 0.5, "left_knee") - Vec3(0, 0, -1)).norm() < kNear);
  CHECK((smpl_bone(motion, 0.5, "right_knee") - Vec3(0, -1, 0)).norm() < kNear);
  CHECK(smpl_bone(motion, 1, "left_elbow").z() > 0.7);
  CHECK(smpl_bone(motion, 1, "left_hip").z() > 0.7);
}

TEST_CASE("a person travels as far as its legs are long") {
  const TemporaryFolder folder;
  const CaptureMotion motion = on_human(folder.write("a.npz", amass(kSteps)));
  const auto at = [&](double t) {
    return rigged_human().own_axes(motion.joints_at(t)[0] * rigged_human().joints[0].position);
  };
  const Vec3 way = at(0.5) - at(0);
  CHECK(way.z() > 0.25);  // half a metre of some 1.7
  CHECK(way.z() < 0.35);
  CHECK(std::abs(way.x()) < kSameJoint);
  CHECK(std::abs(way.y()) < kSameJoint);
}

TEST_CASE("z up, as in AMASS, or y up, and any way to write the same poses down, give the same motion") {
  const TemporaryFolder folder;
  const CaptureMotion motion = on_human(folder.write("a.npz", amass(kSteps)));
  const Eigen::Quaterniond z_up(Eigen::AngleAxisd(std::numbers::pi / 2, Vec3::UnitX()));
  CHECK(farthest_between(motion, on_human(folder.write("z.npz", amass(kSteps, 52, z_up)))) < kSameJoint);
  for (const std::size_t joints : {22, 24, 55}) {
    CAPTURE(joints);
    CHECK(farthest_between(motion, on_human(folder.write("j.npz", amass(kSteps, joints)))) < kSameJoint);
  }
  std::vector<double> root, body;
  for (const SmplFrame& frame : kSteps) {
    const std::vector<double> all = smpl_angles({frame}, 22);
    root.insert(root.end(), all.begin(), all.begin() + 3);
    body.insert(body.end(), all.begin() + 3, all.end());
  }
  CHECK(farthest_between(motion, on_human(folder.write("s.npz", npz({{"root_orient", npy(root, "(3, 3)")},
                                                                     {"pose_body", npy(body, "(3, 63)")},
                                                                     {"trans", npy(smpl_places(kSteps), "(3, 3)")},
                                                                     {"mocap_frame_rate", npy({25}, "()")}})))) <
        kSameJoint);
}

TEST_CASE("the kind of 6D rotations is found: columns or rows, travel in front or behind, axes mixed or not") {
  const TemporaryFolder folder;
  const CaptureMotion motion = on_human(folder.write("a.npz", amass(kSteps)));
  const auto written = [&](const std::vector<SmplFrame>& frames, bool rows, bool mixed, int travel) {
    std::vector<double> out;
    for (const SmplFrame& frame : frames) {
      if (travel == 1) out.insert(out.end(), frame.place.begin(), frame.place.end());
      for (std::size_t j = 0; j < 22; ++j) {
        Eigen::Matrix3d m = smpl_turn(frame, j).toRotationMatrix();
        if (rows) m.transposeInPlace();
        for (int k = 0; k < 6; ++k) out.push_back(mixed ? m(k / 2, k % 2) : m(k % 3, k / 3));
      }
      if (travel == 2) out.insert(out.end(), frame.place.begin(), frame.place.end());
    }
    return folder.write("a.npy", npy(out, travel > 0 ? shape_text(frames.size(), 135)
                                                     : "(" + std::to_string(frames.size()) + ", 22, 6)"));
  };
  for (int kind = 0; kind < 8; ++kind) {
    const bool rows = kind % 2 == 1, mixed = kind / 2 % 2 == 1;
    const int travel = 1 + kind / 4;
    CAPTURE(kind);
    CHECK(farthest_between(motion, on_human(written(kSteps, rows, mixed, travel))) < kSameJoint);
  }
  CHECK(on_human(written(kSteps, false, false, 0)).rate() == doctest::Approx(30));
  const auto read = [](const fs::path& file) { read_capture(file); };
  CHECK(contains(refusal(written({kSteps[0], kSteps[0]}, false, false, 0), read), "neither knees nor elbows"));
  CHECK(contains(refusal(folder.write("p.npy", npy(std::vector<double>(66, 0.3), "(1, 22, 3)")), read), "66 numbers"));
}

TEST_CASE("tables of a motion that do not fit each other are refused") {
  const TemporaryFolder folder;
  const auto says = [&](const std::vector<std::pair<std::string, std::string>>& tables, const char* part) {
    const std::string what = refusal(folder.write("b.npz", npz(tables)), [](const auto& file) { read_capture(file); });
    CAPTURE(what);
    CHECK(contains(what, part));
  };
  const std::string poses = npy(smpl_angles(kSteps, 22), "(3, 66)");
  says({{"poses", npy(std::vector<double>(63, 0), "(1, 63)")}}, "63 angles a frame");
  says({{"poses", npy({}, "(0, 66)")}}, "no frames");
  says({{"poses", npy(std::vector<double>(66, NAN), "(1, 66)")}}, "'poses' has a number that is not finite");
  says({{"poses", npy(std::vector<std::string>{"a"})}}, "'poses' is no table");
  says({{"poses", poses}, {"trans", npy({1, 2, 3}, "(1, 3)")}},
       "'trans' has 1 rows of 3 numbers; the poses have 3 frames");
  says({{"poses", poses}, {"fps", npy({0}, "()")}}, "'fps' is no number");
  says({{"pose_body", npy(std::vector<double>(63, 0), "(1, 63)")}}, "no 'root_orient'");
  says({{"betas", npy({1}, "(1,)")}}, "neither a motion nor a character, only 'betas'");
}
