// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/motion/clip.h"

#include <doctest/doctest.h>
#include <cmath>
#include <fstream>
#include <numbers>

#include "baker/import/moved_nodes.h"
#include "baker/mesh/error.h"
#include "baker/motion/sequence.h"
#include "temporary_folder.h"

using namespace spherechain::baker;

namespace {

Channel channel(ChannelPath path, Interpolation interpolation, std::vector<double> times, std::vector<double> values) {
  return {path, 0, interpolation, std::move(times), std::move(values)};
}

// An upper arm from the origin along x, a fore arm from (1, 0, 0) on; the scene is in another unit and turned.
SourceRig arm(const Affine& scene) {
  SourceRig rig;
  Node root, upper, fore;
  root.local = scene;
  upper.name = "upper";
  upper.parent = 0;
  fore.name = "fore";
  fore.parent = 1;
  fore.translation = {1, 0, 0};
  fore.local.translation() = fore.translation;
  rig.nodes = {root, upper, fore};
  Affine to_fore = Affine::Identity();
  to_fore.translation() = Vec3(-1, 0, 0);
  rig.bones = {{1, Affine::Identity()}, {2, to_fore}};
  rig.to_rest = scene.inverse();
  return rig;
}

Clip bend(double degrees) {
  const double half = degrees * std::numbers::pi / 360;
  Channel turn = channel(ChannelPath::kRotation, Interpolation::kLinear, {0, 2},
                         {0, 0, 0, 1, 0, 0, std::sin(half), std::cos(half)});
  turn.target = 2;
  return {"bend", 2, {turn}};
}

}  // namespace

TEST_CASE("a linear channel is straight between its keys and holds its ends") {
  const Channel c = channel(ChannelPath::kTranslation, Interpolation::kLinear, {1, 3}, {0, 0, 0, 2, 4, 6});
  CHECK(sample(c, 0).isZero());
  CHECK(sample(c, 1.5).isApprox(Eigen::Vector4d(0.5, 1, 1.5, 0)));
  CHECK(sample(c, 99).isApprox(Eigen::Vector4d(2, 4, 6, 0)));
}

TEST_CASE("a step channel keeps a key's value up to the next key") {
  const Channel c = channel(ChannelPath::kMorphWeight, Interpolation::kStep, {0, 1, 2}, {5, 6, 7});
  CHECK(sample(c, 0.999)[0] == 5);
  CHECK(sample(c, 1)[0] == 6);
  CHECK(sample(c, 2)[0] == 7);
}

TEST_CASE("a cubic spline channel follows the cubic its tangents are taken from") {
  // x^3 - 2x + 1 at 0, 2 and 3: in-tangent, value, out-tangent.
  const auto f = [](double x) { return x * x * x - 2 * x + 1; };
  const auto slope = [](double x) { return 3 * x * x - 2; };
  std::vector<double> values;
  for (const double x : {0.0, 2.0, 3.0}) values.insert(values.end(), {slope(x), f(x), slope(x)});
  const Channel c = channel(ChannelPath::kMorphWeight, Interpolation::kCubicSpline, {0, 2, 3}, values);
  for (double x = 0; x <= 3; x += 0.1) CHECK(std::abs(sample(c, x)[0] - f(x)) < 1e-12);
}

TEST_CASE("a rotation turns at an even pace along the shorter way") {
  const double h = std::sin(std::numbers::pi / 4);
  // A quarter turn about z, its quaternion given with the other sign.
  const Channel c = channel(ChannelPath::kRotation, Interpolation::kLinear, {0, 1}, {0, 0, 0, 1, 0, 0, -h, -h});
  const Eigen::Vector4d third = sample(c, 1.0 / 3);
  CHECK(std::abs(std::abs(third[3]) - std::cos(std::numbers::pi / 12)) < 1e-12);
}

TEST_CASE("a clip bends a skinned arm, whatever the scene's axes and units") {
  Affine turned = Affine::Identity();
  turned.linear() = 0.01 * Eigen::AngleAxisd(-std::numbers::pi / 2, Vec3::UnitX()).toRotationMatrix();
  turned.translation() = Vec3(3, 4, 5);
  for (const Affine& scene : {Affine(Affine::Identity()), turned}) {
    const SourceRig rig = arm(scene);
    const Clip clip = bend(90);
    const std::vector<Vec3> rest{{0.5, 0, 0}, {2, 0, 0}, {1, 0.5, 0}};
    const std::vector<VertexWeights> weights{{{0}, {1}}, {{1}, {1}}, {{0, 1}, {0.5, 0.5}}};
    const ClipMotion motion(rig, {&clip});
    CHECK(motion.duration() == 2);
    CHECK(motion.place(0.5).seconds == 1);
    const std::vector<Vec3> start = deform(rest, weights, motion.at(0).bones),
                            end = deform(rest, weights, motion.at(1).bones);
    for (std::size_t v = 0; v < rest.size(); ++v) CHECK((start[v] - rest[v]).norm() < 1e-12);
    CHECK((end[0] - rest[0]).norm() < 1e-12);
    CHECK((end[1] - Vec3(1, 1, 0)).norm() < 1e-12);
    // Half of it stays, half goes to (0.5, 0, 0).
    CHECK((end[2] - Vec3(0.75, 0.25, 0)).norm() < 1e-12);
  }
}

TEST_CASE("a clip's rate is that of most of its keys, whether or not keys are missing or lie between") {
  const auto rate = [](std::vector<double> times) {
    Clip clip = bend(90);
    clip.channels[0].times = std::move(times);
    return rate_of(clip);
  };
  std::vector<double> times;
  for (int k = 0; k < 24; ++k) times.push_back(k / 24.0);
  CHECK(rate(times) == 24);
  times.insert(times.begin() + 7, 0.28);
  CHECK(rate(times) == doctest::Approx(24).epsilon(1e-3));
  times.erase(times.begin() + 12, times.begin() + 15);
  CHECK(rate(times) == doctest::Approx(24).epsilon(1e-3));
}

TEST_CASE("clips play one after another, each from its own start") {
  const SourceRig rig = arm(Affine::Identity());
  const Clip first = bend(90), second{"still", 2, {}};
  const ClipMotion motion(rig, {&first, &second});
  CHECK(motion.duration() == 4);
  CHECK(motion.place(0.25).clip == 0);
  CHECK(motion.place(0.75).clip == 1);
  CHECK(motion.place(0.75).seconds == 1);
  CHECK(motion.at(0.75).bones[1].isApprox(Affine::Identity()));
  const ClipMotion other_way(rig, {&second, &first});
  CHECK(other_way.at(0.75).bones[1].isApprox(sample(rig, first, 1).bones[1]));
}

TEST_CASE("morph weights displace the rest pose before the bones turn it") {
  SourceRig rig = arm(Affine::Identity());
  rig.morphs = {{"bulge", {1}, {{0, 0, 1}}, 0.25}, {"other", {0}, {{7, 7, 7}}, 0}};
  Clip clip = bend(90);
  clip.channels.push_back(channel(ChannelPath::kMorphWeight, Interpolation::kLinear, {0, 2}, {0, 1}));
  const std::vector<Vec3> rest{{0.5, 0, 0}, {2, 0, 0}};
  const std::vector<VertexWeights> weights{{{0}, {1}}, {{1}, {1}}};
  const Deformation end = sample(rig, clip, 2);
  const std::vector<Vec3> now = deform(morph(rest, rig.morphs, end.morphs), weights, end.bones);
  CHECK((now[1] - Vec3(1, 1, 1)).norm() < 1e-12);
  CHECK((now[0] - rest[0]).norm() < 1e-12);
  CHECK(sample(rig, bend(90), 0).morphs[0] == 0.25);
}

namespace {

void write_tetrahedron(const std::filesystem::path& file, double top, bool open = false) {
  std::ofstream(file) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 " << top << "\nf 1 3 2\nf 1 2 4\nf 2 3 4\n"
                      << (open ? "" : "f 3 1 4\n");
}

}  // namespace

TEST_CASE("a folder of meshes plays frame by frame, or as poses of a Bezier curve") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path / "frames");
  write_tetrahedron(folder.path / "rest.obj", 1);
  for (int i = 0; i < 3; ++i) write_tetrahedron(folder.path / ("frames/f" + std::to_string(i) + ".obj"), 2 + i * i);
  std::ofstream(folder.path / "frames/notes.md") << "beside the meshes";
  std::ofstream(folder.path / "list.txt") << "frames/f2.obj\r\nframes/f0.obj\n\n";
  const Character rest = import_character(folder.path / "rest.obj");
  const auto top = [](const Deformation& d) {
    double z = 0;
    for (const Vec3& p : d.positions) z = std::max(z, p.z());
    return z;
  };
  const SequenceMotion frames(rest, sequence_files(folder.path / "frames"), SequenceMotion::Path::kFrames);
  CHECK(frames.frame_count() == 3);
  CHECK(top(frames.at(0)) == 2);
  CHECK(top(frames.at(0.5)) == 3);
  CHECK(top(frames.at(0.75)) == 4.5);
  CHECK(top(frames.at(1)) == 6);
  const SequenceMotion poses(rest, sequence_files(folder.path / "frames"), SequenceMotion::Path::kBezier);
  CHECK(top(poses.at(0)) == 1);
  CHECK(std::abs(top(poses.at(1.0 / 3)) - 2) < 1e-12);
  CHECK(std::abs(top(poses.at(2.0 / 3)) - 3) < 1e-12);
  CHECK(top(poses.at(1)) == 6);
  const SequenceMotion listed(rest, sequence_files(folder.path / "list.txt"), SequenceMotion::Path::kFrames);
  CHECK(top(listed.at(0)) == 6);
  CHECK(top(listed.at(1)) == 2);
  for (const std::string& out : {std::string("../rest.obj"), (folder.path / "rest.obj").string()}) {
    std::ofstream(folder.path / "frames/list.txt") << out;
    CHECK_THROWS_WITH_AS(sequence_files(folder.path / "frames/list.txt"), doctest::Contains(out.c_str()), Error);
  }
}

TEST_CASE("a sequence whose mesh has another topology is refused by that file's name") {
  const TemporaryFolder folder;
  write_tetrahedron(folder.path / "rest.obj", 1);
  write_tetrahedron(folder.path / "other.obj", 2, true);
  const Character rest = import_character(folder.path / "rest.obj");
  const auto complaint = [&](const std::vector<std::filesystem::path>& files) -> std::string {
    try {
      SequenceMotion(rest, files, SequenceMotion::Path::kFrames);
    } catch (const Error& error) {
      CHECK(error.code() == ExitCode::kFile);
      return error.what();
    }
    return "";
  };
  CHECK(complaint({folder.path / "other.obj"}).find("other.obj: has other vertices or triangles") != std::string::npos);
  CHECK(complaint({folder.path / "gone.obj"}).find("gone.obj") != std::string::npos);
  std::filesystem::create_directory(folder.path / "empty");
  CHECK_THROWS_AS(sequence_files(folder.path / "empty"), Error);
}

TEST_CASE("a pose needs the nodes alone that move a bone: the others change nothing") {
  SourceRig rig;
  const auto add = [&](int parent, double x) {
    Node node;
    node.parent = parent;
    node.local.translation() = Vec3(x, 1, 0);
    rig.nodes.push_back(node);
  };
  add(-1, 1);  // 0: above all, still
  add(0, 2);   // 1: turns
  add(1, 3);   // 2: the bone
  add(1, 4);   // 3: turns, without a bone
  add(0, 5);   // 4: a bone that nothing moves
  for (const Index n : {2U, 4U}) rig.bones.push_back({n, Affine::Identity()});
  const MovedNodes moved(rig, {0, 1, 0, 1, 0});
  CHECK(moved.list() == std::vector<Index>{1, 2});

  std::vector<Affine> world;
  for (const Index n : moved.list()) {
    rig.nodes[n].local.translation().z() = 7;
    world.push_back(moved.world(static_cast<Index>(rig.nodes[n].parent), world) * rig.nodes[n].local);
  }
  const std::vector<Affine> all = world_of(rig.nodes), bones = moved.deformation(rig, world);
  REQUIRE(bones.size() == 2);
  CHECK(bones[0].isApprox(all[2]));
  CHECK(bones[1].isApprox(all[4]));
}
