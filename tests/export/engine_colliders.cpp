// SPDX-License-Identifier: GPL-3.0-or-later
// engine_colliders FOLDER POSES SHAPE: bodies that no character has, in random poses.
// engine_colliders FOLDER POSES SHAPE ASSET SOURCE [MOTION OR POSES...]: a character's.
// Writes the exports for engines into FOLDER, and ours.json: the same volumes and which overlap (posed_json.h).
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <random>

#include "baker/export/formats.h"
#include "baker/play/play.h"
#include "baker/volumes/fit_volumes.h"
#include "posed_json.h"

using namespace spherechain::baker;
namespace test = spherechain::test;

namespace {

class Chance {
 public:
  double between(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
  Vec3 point(double reach) { return {between(-reach, reach), between(-reach, reach), between(-reach, reach)}; }
  Eigen::Quaterniond turn() {
    Eigen::Quaterniond out;
    out.coeffs() << point(1), between(-1, 1);
    return out.normalized();
  }
  Eigen::Isometry3d place() { return Eigen::Translation3d(point(0.5)) * turn(); }

 private:
  std::mt19937 engine_{1};
};

// Metres, as large as a person; a part with a name and a bone that every format has to escape.
Colliders made_colliders(Chance& chance, const std::string& shape) {
  Colliders out;
  out.source_file = "made \"up\".glb";
  out.height = 1.7;
  out.left = Vec3::UnitX();
  out.up = Vec3::UnitY();
  out.forward = Vec3::UnitZ();
  const auto radius = [&] { return chance.between(0.03, 0.15); };
  for (int i = 0; i < 8; ++i) {
    ColliderBody body;
    body.name = i == 0 ? "2nd \"part\" \\ of it" : "part " + std::to_string(i);
    body.bone = i == 0 ? "mixamorig:Hips \"0\"" : "bone." + std::to_string(i);
    body.parent = i - 1;
    body.rest = chance.place();
    for (int k = 0; k < 3; ++k) {
      const double same = radius();
      if (k == 0)
        body.volumes.emplace_back(BallVolume{chance.point(0.2), same});
      else if (shape == "capsules")
        body.volumes.emplace_back(ConeVolume{chance.point(0.2), chance.point(0.2), same, same});
      else if (shape == "cones")
        body.volumes.emplace_back(ConeVolume{chance.point(0.2), chance.point(0.2), radius(), radius()});
      else if (shape == "boxes")
        body.volumes.emplace_back(BoxVolume{chance.point(0.2), chance.turn(), {radius(), radius(), radius()}});
      else
        body.volumes.emplace_back(EllipsoidVolume{chance.point(0.2), chance.turn(), {radius(), radius(), radius()}});
    }
    // Along an axis, either way: where turning to a direction has no axis to turn about.
    if (shape == "capsules" || shape == "cones") {
      const double other = shape == "cones" ? 0.03 : 0.05;
      for (const Vec3& along : {Vec3(0, 0.2, 0), Vec3(0, -0.2, 0), Vec3(0, 0, 0.2), Vec3(0, 0, -0.2)}) {
        body.volumes.emplace_back(ConeVolume{Vec3::Zero(), along, 0.05, other});
      }
    }
    out.bodies.push_back(body);
  }
  for (int i = 1; i < 8; ++i) out.ignored.push_back({i - 1, i, IgnoredReason::kAdjacent});
  return out;
}

void write_exports(const Colliders& colliders, const std::filesystem::path& folder, bool has_ellipsoids) {
  const auto write = [&](const char* name, const Export& made) {
    for (const ExportFile& file : made.files) {
      std::ofstream(folder / (file.ending.empty() ? name : file.ending), std::ios::binary) << file.bytes;
    }
  };
  write("capsules.json", export_json(colliders));
  write("usd.usda", export_usd(colliders));
  if (has_ellipsoids) return;  // the others have none
  write("godot.tscn", export_godot(colliders));
  write("unity.json", export_unity(colliders));
  write("unreal.json", export_unreal(colliders));
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 4) return 2;
  const std::filesystem::path folder = argv[1];
  const int poses = std::atoi(argv[2]);
  const std::string shape = argv[3];
  Colliders colliders;
  nlohmann::ordered_json ours;
  if (argc < 6) {
    Chance chance;
    colliders = made_colliders(chance, shape);
    ours = test::json_of(colliders);
    for (int i = 0; i < poses; ++i) {
      std::vector<Eigen::Isometry3d> at;
      for (std::size_t b = 0; b < colliders.bodies.size(); ++b) at.push_back(chance.place());
      test::add_pose(ours, colliders, at, {});
    }
  } else {
    std::vector<MotionChoice> motions;
    for (int i = 6; i < argc; ++i) {
      motions.emplace_back();
      (std::string_view(argv[i]).ends_with(".json") ? motions.back().poses : motions.back().motion) = argv[i];
    }
    if (motions.empty()) motions.emplace_back();
    AnimatedAsset animated(argv[4], argv[5], motions[0], {poses, 30});
    colliders = fit_volumes(animated.asset(), volume_shape(shape), 0);
    ours = test::json_of(colliders);
    for (const MotionChoice& motion : motions) {
      animated.play(motion, {poses, 30});
      for (int i = 0; i < animated.frame_count(); ++i) {
        test::add_pose(ours, colliders, posed(colliders, animated.deformation(i).bones), {});
      }
    }
  }
  write_exports(colliders, folder, shape == "ellipsoids");
  std::ofstream(folder / "ours.json") << ours.dump();
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
