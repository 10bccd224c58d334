// SPDX-License-Identifier: GPL-3.0-or-later
#include "moving_human.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>

#include "motion/capture.h"
#include "motion/poses.h"

namespace spherechain::test {
namespace {

constexpr const char* kModels = "/usr/share/assimp/models/";
constexpr int kCaptureFrames = 24;

}  // namespace

const MovingHuman& moving_human() {
  static const MovingHuman result{
      baker::bake(std::string(kModels) + "Collada/human.zae", baker::make_settings("balanced", "{}", "test"), {})};
  return result;
}

Asset MovingHuman::asset() const {
  Asset out;
  char message[256] = "";
  REQUIRE_MESSAGE(out.open(bake.asset.data(), bake.asset.size(), message, sizeof message) == Status::kOk, message);
  return out;
}

std::vector<float> MovingHuman::rest_positions() const { return baker::pack(bake.character.source_positions); }

std::vector<float> MovingHuman::deformed(const baker::Deformation& deformation) const {
  return baker::pack(baker::deform(bake.character.source_positions, bake.rig_weights, deformation.bones));
}

std::vector<MovingHuman::Frame> MovingHuman::frames() const {
  std::vector<Frame> out;
  const baker::CaptureMotion boxing(baker::read_capture(std::filesystem::path(kModels) / "BVH/Boxing_Toes.bvh"),
                                    baker::body_of(bake.joints, bake.regions.frame));
  for (int i = 0; i < kCaptureFrames; ++i) {
    out.push_back({"Boxing_Toes.bvh, frame " + std::to_string(i), boxing.at(i / (kCaptureFrames - 1.0))});
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(SPHERECHAIN_SAMPLES "/poses")) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    const baker::BezierMotion motion(bake.joints, bake.regions.frame, baker::read_pose_motion(file, bake.joints));
    for (const double t : {0.5, 1.0}) {
      out.push_back({file.filename().string() + " at " + std::to_string(t), motion.at(t)});
    }
  }
  return out;
}

}  // namespace spherechain::test
