// SPDX-License-Identifier: GPL-3.0-or-later
// A robot's motion as CSV, against places worked by hand and MuJoCo's.
#include "baker/motion/robot_motion.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "array_bytes.h"
#include "baker/import/notes.h"
#include "baker/motion/clip.h"
#include "refusal.h"
#include "small_robot.h"

using namespace spherechain::baker;

namespace {

// The place of a node in the last frame of a motion.
Vec3 place_of(const SourceRig& rig, const Capture& capture, const std::string& link) {
  const std::vector<Affine> world = world_at(rig, capture.clip, capture.clip.duration);
  for (std::size_t n = 0; n < rig.nodes.size(); ++n) {
    if (rig.nodes[n].name == link) return world[n].translation();
  }
  return Vec3::Constant(NAN);
}

}  // namespace

TEST_CASE("a header names joints, and mimics follow") {
  const small_robot::Files files;
  const SourceRig rig = read_source(files.urdf()).rig;
  const Capture capture =
      read_robot_motion(files.write("a.csv", "time,elbow,turn\n2,0,0\n2.5,1.5707963267949,0\n"), rig);
  CHECK(capture.clip.duration == 0.5);
  // The elbow is at (0, 0.12, 0.51), and z of the upper arm goes to x.
  CHECK(place_of(rig, capture, "tool").isApprox(Vec3(0.6, 0.12, 0.51), 1e-9));
  CHECK(place_of(rig, capture, "lamp").isApprox(Vec3(0.6, 0.12, 0.31), 1e-9));
  const std::vector<Affine> world = world_at(rig, capture.clip, 0.5);
  // The lamp turns by half of that the other way, and 0.1 from where it is mounted.
  const double angle = std::numbers::pi / 2 - std::numbers::pi / 4 + 0.1;
  CHECK(world.back().linear().isApprox(Eigen::AngleAxisd(angle, Vec3::UnitY()).toRotationMatrix(), 1e-9));
}

TEST_CASE("rows without a header have the root and the joints in the file's order") {
  const small_robot::Files files;
  const SourceRig rig = read_source(files.urdf()).rig;
  const std::string row = "1,2,3,0,0,0.70710678,0.70710678,0.5,1.5707963267949\n";
  const Capture capture = read_robot_motion(files.write("a.csv", row + row), rig);
  CHECK(capture.clip.duration == doctest::Approx(1 / kRobotFps));
  const Vec3 elbow(1 - 0.12 * std::cos(0.5), 2 - 0.12 * std::sin(0.5), 3.51);
  const Vec3 along(-std::sin(0.5), std::cos(0.5), 0);
  CHECK(place_of(rig, capture, "tool").isApprox(elbow + 0.6 * along, 1e-7));
  CHECK(read_robot_motion(files.write("b.csv", "0.5,1\n"), rig).clip.duration == 0);
}

TEST_CASE("the tables of research data move a robot as a CSV does") {
  const small_robot::Files files;
  const SourceRig rig = read_source(files.urdf()).rig;
  const std::string row = "1,2,3,0,0,0.6,0.8,";
  const auto tables = [&](const std::vector<double>& joints, const std::vector<std::string>& names) {
    std::vector<std::pair<std::string, std::string>> out{{"fps", npy({50}, "()")},
                                                         {"root_pos", npy({1, 2, 3, 1, 2, 3}, "(2, 3)")},
                                                         {"root_rot", npy({0, 0, 0.6, 0.8, 0, 0, 0.6, 0.8}, "(2, 4)")},
                                                         {"dof_pos", npy(joints, "(2, 2)")}};
    if (!names.empty()) out.emplace_back("dof_names", npy(names));
    return read_robot_motion(files.write("a.npz", npz(out)), rig);
  };
  const Capture capture = tables({0, 0, 0.5, 1.5}, {}), named = tables({0, 0, 1.5, 0.5}, {"elbow", "turn"}),
                csv = read_robot_motion(files.write("a.csv", row + "0,0\n" + row + "0.5,1.5\n"), rig);
  CHECK(capture.clip.duration == doctest::Approx(1 / 50.0));
  CHECK(place_of(rig, capture, "tool").isApprox(place_of(rig, csv, "tool"), 1e-9));
  CHECK(place_of(rig, named, "tool").isApprox(place_of(rig, csv, "tool"), 1e-9));
}

TEST_CASE("a humanoid moves as in MuJoCo") {
  // The bodies of its humanoid as mj_kinematics of MuJoCo 2.2.2 places them (Debian's libmujoco-samples): hinge i is at
  // 0.05 i, every second one backwards.
  const SourceRig rig = read_source("/usr/share/mujoco/model/humanoid/humanoid.xml").rig;
  std::string row = "0.1,-0.2,1.5,0.5,-0.5,0.5,0.5";
  for (int i = 1; i <= 21; ++i) row += "," + std::to_string((i % 2 != 0 ? 0.05 : -0.05) * i);
  const small_robot::Files files;
  const Capture capture = read_robot_motion(files.write("a.csv", row + "\n"), rig);
  CHECK((place_of(rig, capture, "pelvis") - Vec3(0.083933, 0.222734, 1.512074)).norm() < 2e-6);
  CHECK((place_of(rig, capture, "right_foot") - Vec3(0.070334, 0.910879, 1.943425)).norm() < 2e-6);
  CHECK((place_of(rig, capture, "left_foot") - Vec3(-0.050990, 0.691283, 2.072416)).norm() < 2e-6);
  CHECK((place_of(rig, capture, "right_hand") - Vec3(0.158508, -0.489843, 1.982111)).norm() < 2e-6);
  CHECK((place_of(rig, capture, "left_hand") - Vec3(-0.015367, -0.263483, 1.513318)).norm() < 2e-6);
  take_notes();
}

TEST_CASE("a CSV that does not fit the robot is refused, and one beyond its limits noted") {
  const small_robot::Files files;
  const SourceRig rig = read_source(files.urdf()).rig;
  const auto refused = [&](const std::string& text) {
    return refusal(files.write("a.csv", text), [&](const auto& file) { read_robot_motion(file, rig); });
  };
  CHECK(contains(refused("1,2,3\n"),
                 "has 3 numbers in a row, and the robot needs 9 (7 of its root and 2 of its joints), or 2"));
  CHECK(contains(refused("turn,elbow\n1,2\n1\n"), "line 3: has 1 numbers"));
  CHECK(contains(refused("1,2\n1,x\n"), "line 2: 'x' is no number"));
  CHECK(contains(refused("1,2\n1,inf\n"), "is no number"));
  CHECK(contains(refused("time,turn\n0,1\n0,2\n"), "its time is not after"));
  CHECK(contains(refused("knee,hip\n0,1\n"), "names no joint"));
  CHECK(contains(refused("root_x,turn\n0,1\n"), "needs all seven or none"));
  CHECK(contains(refused("0,0,0,0,0,0,0,1,1\n"), "quaternion has no length"));
  CHECK(contains(refused(""), "has no rows"));
  take_notes();
  CHECK(refused("turn,elbow\n9,3.5\n") == "accepted");
  const std::vector<std::string> notes = take_notes();
  REQUIRE(notes.size() == 1);
  CHECK(contains(notes[0], "joint 'elbow' goes to 3.5, beyond its limits -3 to 3"));
}
