// SPDX-License-Identifier: GPL-3.0-or-later
#include "moving_human.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>

#include "baker/motion/capture.h"
#include "baker/motion/poses.h"
#include "baker/play/play.h"

namespace spherechain::test {
namespace {

constexpr const char* kModels = "/usr/share/assimp/models/";
constexpr int kCaptureFrames = 24;

MovingHuman make() {
  baker::Bake bake =
      baker::bake(std::string(kModels) + "Collada/human.zae", baker::make_settings("balanced", "{}", "test"), {});
  baker::OpenAsset asset({reinterpret_cast<const char*>(bake.asset.data()), bake.asset.size()}, "human.sphc");
  MovingHuman human{std::move(bake), std::move(asset), {}, {}};
  const baker::Bake& b = human.bake;
  human.rest = baker::pack(b.character.source_positions);
  const auto add = [&](const std::string& name, const baker::Deformation& deformation) {
    human.frames.push_back(
        {name, baker::bone_palette(human.asset, deformation),
         baker::pack(baker::deform(b.character.source_positions, b.rig_weights, deformation.bones))});
  };
  const baker::CaptureMotion boxing(baker::read_capture(std::filesystem::path(kModels) / "BVH/Boxing_Toes.bvh"),
                                    baker::body_of(b.joints, b.regions.frame, b.character.file));
  for (int i = 0; i < kCaptureFrames; ++i) {
    add("Boxing_Toes.bvh, frame " + std::to_string(i), boxing.at(i / (kCaptureFrames - 1.0)));
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(SPHERECHAIN_SAMPLES "/poses")) {
    if (entry.path().extension() == ".json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    const baker::BezierMotion motion(b.joints, b.regions.frame, baker::read_pose_motion(file, b.joints));
    for (const double t : {0.5, 1.0}) {
      add(file.filename().string() + " at " + std::to_string(t), motion.at(t));
    }
  }
  return human;
}

}  // namespace

const MovingHuman& moving_human() {
  static const MovingHuman human = make();
  return human;
}

const std::uint64_t* human_skin_table() {
  static const PreparedSkin table(*moving_human().asset.handle());
  return table.words.data();
}

const baker::TruthSurface& truth_surface() {
  static const baker::TruthSurface surface = baker::surface_of(moving_human().asset, moving_human().bake.character);
  return surface;
}

MovingHuman::Frame skinned(MovingHuman::Frame frame) {
  const std::vector<float> moved = skin(*moving_human().asset.handle(), bones_of(frame.palette));
  const spherechain::Surface& surface = moving_human().asset.surface();
  const baker::TruthSurface& triangles = truth_surface();
  for (std::size_t i = 0; i < triangles.corners.size(); ++i) {
    const std::uint32_t place = surface.place_of_source[triangles.source_triangle[i]];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t from = surface.source_vertices[surface.triangle_vertices[3 * std::size_t{place} + k]];
      std::copy_n(&moved[3 * from], 3, &frame.vertices[3 * std::size_t{triangles.corners[i][k]}]);
    }
  }
  return frame;
}

Pose vertices_of(const std::vector<float>& vertices) {
  Pose pose;
  pose.vertices = vertices.data();
  pose.vertex_count = vertices.size() / 3;
  return pose;
}

Pose bones_of(const std::vector<float>& palette) {
  Pose pose;
  pose.bones = palette.data();
  pose.bone_count = palette.size() / 12;
  pose.bone_layout = SC_ROWS_3X4;
  return pose;
}

Pose both_of(const MovingHuman::Frame& frame) {
  Pose pose = bones_of(frame.palette);
  pose.vertices = frame.vertices.data();
  pose.vertex_count = frame.vertices.size() / 3;
  return pose;
}

SkinContactJob job_of(const Pose& pose, Target target) {
  SkinContactJob job;
  job.asset = moving_human().asset.handle();
  job.skin_table = human_skin_table();
  job.pose = pose;
  job.target = target;
  return job;
}

SkinContacts run(const SkinContactJob& job) {
  SkinContacts found = find_contacts(job);
  REQUIRE(found.status == SC_OK);
  return found;
}

StepContacts run(const StepJob& job) {
  StepContacts found = find_contacts(job);
  REQUIRE(found.status == SC_OK);
  return found;
}

std::vector<float> blended(const std::vector<float>& from, const std::vector<float>& to, double t) {
  std::vector<float> out(from.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    out[i] = static_cast<float>(double{from[i]} + t * (double{to[i]} - double{from[i]}));
  }
  return out;
}

std::vector<Pair> triangle_pairs(const SkinContacts& found) {
  std::vector<Pair> out;
  for (const TriangleContact& contact : found.triangles) out.push_back({contact.triangle_a, contact.triangle_b});
  return out;
}

}  // namespace spherechain::test
