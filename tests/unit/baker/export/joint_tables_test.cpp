// SPDX-License-Identifier: GPL-3.0-or-later
// Joint angles of clips, put into the robot's file by its own reader. tests/export/mjcf.mjs has MuJoCo's answer.
#include "baker/export/joint_tables.h"

#include <doctest/doctest.h>

#include <random>

#include "baker/export/robot.h"
#include "baker/import/notes.h"
#include "baker/motion/clip.h"
#include "baker/motion/robot_motion.h"
#include "temporary_folder.h"

using namespace spherechain::baker;

namespace {

Eigen::Isometry3d random_place(std::mt19937& random, double angle_max) {
  std::uniform_real_distribution<double> any(-1, 1);
  const Eigen::AngleAxisd turn(angle_max * any(random), Vec3(any(random), any(random), any(random)).normalized());
  Eigen::Isometry3d out(turn);
  out.translation() = Vec3(any(random), any(random), any(random));
  return out;
}

}  // namespace

TEST_CASE("a URDF with the joint angles of a clip stands as the clip does, where parts slide, too") {
  std::mt19937 random(7);
  Colliders figure;
  figure.source_file = "figure.glb";
  figure.height = 2;
  figure.left = Vec3::UnitX();
  figure.up = Vec3::UnitY();
  figure.forward = Vec3::UnitZ();
  for (const int parent : {-1, 0, 1, 1, -1}) {
    ColliderBody body;
    body.name = "part " + std::to_string(figure.bodies.size());
    body.parent = parent;
    body.rest = random_place(random, 3);
    body.volumes = {BallVolume{Vec3::Zero(), 0.1}};
    figure.bodies.push_back(body);
  }
  std::vector<PosedClip> clips{{"walk left/right", {}, {}}, {"walk left right", {0}, {{}}}};
  for (int f = 0; f < 40; ++f) {
    clips[0].seconds.push_back(f / 30.0);
    std::vector<Eigen::Isometry3d>& bodies = clips[0].frames.emplace_back();
    for (std::size_t b = 0; b < figure.bodies.size(); ++b) {
      const int parent = figure.bodies[b].parent;
      Eigen::Isometry3d turn = random_place(random, f < 20 ? 0.3 : 3);
      turn.translation() *= parent < 0 || b == 2 ? 0.2 : 0;  // part 2 slides
      const Eigen::Isometry3d above =
          parent < 0 ? Eigen::Isometry3d::Identity() : bodies[static_cast<std::size_t>(parent)];
      bodies.push_back(above * rest_in_parent(figure, b) * turn);
    }
  }
  for (const ColliderBody& body : figure.bodies) clips[1].frames[0].push_back(body.rest);
  const std::string note = allow_motion(clips, figure);
  CHECK(note.find("part 2 (") != note.npos);
  CHECK(note.find("part 1") == note.npos);
  const std::vector<ExportFile> files = urdf_joint_tables(figure, clips);
  REQUIRE(files.size() == 2);
  CHECK(files[0].ending == ".walk_left_right.urdf.csv");
  CHECK(files[1].ending == ".walk_left_right_2.urdf.csv");

  const TemporaryFolder folder;
  const auto write = [&](const char* name, const std::string& text) {
    std::ofstream(folder.path / name) << text;
    return folder.path / name;
  };
  const SourceRig rig = read_source(write("figure.urdf", urdf_of(figure))).rig;
  take_notes();
  const Clip clip = read_robot_motion(write("walk.csv", files[0].bytes), rig).clip;
  CHECK(take_notes().empty());  // no joint goes beyond its limits
  const std::vector<std::string> names = link_names(figure);
  const Eigen::Isometry3d up(to_z_up(figure));
  double farthest = 0, widest = 0;
  for (std::size_t f = 0; f < clips[0].frames.size(); ++f) {
    const std::vector<Affine> world = world_at(rig, clip, clips[0].seconds[f]);
    for (std::size_t b = 0; b < names.size(); ++b) {
      const auto node =
          std::find_if(rig.nodes.begin(), rig.nodes.end(), [&](const Node& n) { return n.name == names[b]; });
      REQUIRE(node != rig.nodes.end());
      const Affine& theirs = world[static_cast<std::size_t>(node - rig.nodes.begin())];
      const Eigen::Isometry3d ours = up * clips[0].frames[f][b];
      farthest = std::max(farthest, (theirs.translation() - ours.translation()).norm());
      widest = std::max(widest, (theirs.linear() - ours.linear()).norm());
    }
  }
  CHECK(farthest < 1e-5);
  CHECK(widest < 1e-5);
}
