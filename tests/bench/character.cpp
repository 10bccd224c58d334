// SPDX-License-Identifier: GPL-3.0-or-later
#include "character.h"

#include <algorithm>
#include <cstring>
#include <filesystem>

#include "baker/mesh/error.h"
#include "baker/motion/capture.h"
#include "baker/motion/poses.h"
#include "runtime/src/refit/refit_job.h"

namespace spherechain::bench {
namespace {

using baker::Deformation;

constexpr const char* kCaptures = "/usr/share/assimp/models/BVH";

void check(Status status, const char* what) {
  if (status != SC_OK) {
    throw baker::Error(baker::ExitCode::kInternal, std::string(what) + ": " + sc_code_text(status.code));
  }
}

std::vector<Deformation> poses_of(const baker::Bake& bake, std::size_t count) {
  const auto motions = motions_of(bake);
  std::vector<Deformation> out;
  for (std::size_t m = 0; m < motions.size(); ++m) {
    const std::size_t frames = count * (m + 1) / motions.size() - count * m / motions.size();
    for (std::size_t i = 0; i < frames; ++i) {
      out.push_back(motions[m].motion->at(static_cast<double>(i + 1) / static_cast<double>(frames)));
    }
  }
  return out;
}

std::vector<float> palette(const Deformation& pose) {
  std::vector<float> out;
  for (const baker::Affine& bone : pose.bones) {
    for (Eigen::Index row = 0; row < 3; ++row) {
      for (Eigen::Index column = 0; column < 4; ++column) {
        out.push_back(static_cast<float>(bone.matrix()(row, column)));
      }
    }
  }
  return out;
}

}  // namespace

std::vector<NamedMotion> motions_of(const baker::Bake& bake) {
  std::vector<NamedMotion> out;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(SPHERECHAIN_SAMPLES "/poses")) {
    if (entry.path().extension() == ".json") {
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    out.push_back(
        {file.stem().string(), std::make_unique<baker::BezierMotion>(bake.joints, bake.regions.frame,
                                                                     baker::read_pose_motion(file, bake.joints))});
  }
  for (const std::string name : {"01_01", "01_03", "Boxing_Toes"}) {
    const auto file = std::filesystem::path(kCaptures) / (name + ".bvh");
    out.push_back(
        {name, std::make_unique<baker::CaptureMotion>(baker::read_capture(file),
                                                      body_of(bake.joints, bake.regions.frame, bake.character.file))});
  }
  return out;
}

Pose PosedCharacter::pose(std::size_t i) const {
  Pose out;
  out.bones = matrices[i].data();
  out.bone_count = view().bone_count();
  out.bone_layout = SC_ROWS_3X4;
  return out;
}

std::vector<float> PosedCharacter::mesh(std::size_t i) const {
  std::vector<float> out;
  out.reserve(3 * bake.character.source_positions.size());
  for (const baker::Vec3& v : deform(bake.character.source_positions, bake.rig_weights, poses[i].bones)) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      out.push_back(static_cast<float>(v[axis]));
    }
  }
  return out;
}

void load(PosedCharacter& character, const std::string& name, const std::string& settings, std::size_t pose_count) {
  character.name = name;
  character.bake = baker::bake(kHuman, baker::make_settings("balanced", settings, "the benchmark's settings"), {});
  const auto& asset = character.bake.asset;
  character.bytes = memory_for((asset.size() + 7) / 8);
  std::memcpy(character.bytes.data(), asset.data(), asset.size());
  check(sc_asset_open(&character.asset, SC_ABI_VERSION, character.bytes.data(), asset.size(), nullptr, 0),
        "the baked asset");
  character.poses = poses_of(character.bake, pose_count);
  for (const Deformation& pose : character.poses) {
    character.matrices.push_back(palette(pose));
    character.spheres.emplace_back(character.sphere_count());
    RefitJob job;
    job.asset = &character.asset;
    job.pose = character.pose(character.matrices.size() - 1);
    job.spheres = character.spheres.back().data();
    job.sphere_capacity = character.sphere_count();
    check(job.run(), "refit from bones");
  }
}

}  // namespace spherechain::bench
