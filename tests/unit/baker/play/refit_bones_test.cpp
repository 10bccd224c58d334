// SPDX-License-Identifier: GPL-3.0-or-later
// Refit from bones on baked characters, against the refit from their skinned meshes.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>

#include "baked_human.h"
#include "baked_person.h"
#include "baker/motion/clip.h"
#include "baker/motion/poses.h"
#include "jobs.h"
#include "test_characters.h"

using namespace spherechain::baker;
using spherechain::Radius;

namespace {

using spherechain::test::refit;

constexpr double kTolerance = 1e-5;  // of the height

// The bone matrices that a game would pass: by columns, the identity for the rest bone.
std::vector<float> palette(const spherechain::baker::OpenAsset& asset, const std::vector<Affine>& bones) {
  std::vector<float> out;
  for (std::size_t b = 0; b < asset->bone_count(); ++b) {
    REQUIRE(asset->bone(b).is_rest == (b == bones.size()));
    const Eigen::Matrix4d m = b < bones.size() ? Eigen::Affine3d(bones[b]).matrix() : Eigen::Matrix4d::Identity();
    for (Eigen::Index i = 0; i < 16; ++i) out.push_back(static_cast<float>(m.data()[i]));
  }
  return out;
}

// The largest difference of a centre's coordinate or a radius, as a fraction of the height.
double worst_difference(const Bake& bake, const std::vector<Deformation>& frames) {
  const spherechain::baker::OpenAsset asset = open_asset_of(bake);
  const SourceRig& rig = bake.character.rig;
  double worst = 0;
  for (const Deformation& frame : frames) {
    const std::vector<Vec3> mesh = deform(morph(bake.character.source_positions, rig.morphs, frame.morphs),
                                          rig.bones.empty() ? bake.rig_weights : rig.weights, frame.bones);
    const std::vector<float> matrices = palette(asset, frame.bones);
    spherechain::Pose pose;
    pose.bones = matrices.data();
    pose.bone_count = asset->bone_count();
    pose.bone_layout = SC_COLUMNS_4X4;
    for (const Radius kind : {SC_RADIUS_FIT, SC_RADIUS_DETECT}) {
      const auto expected = refit(asset, pack(mesh), kind);
      const auto result = refit(asset, pose, kind);
      REQUIRE(expected.status == SC_OK);
      REQUIRE(result.status == SC_OK);
      for (std::size_t i = 0; i < expected.spheres.size(); ++i) {
        const spherechain::Sphere &a = expected.spheres[i], &b = result.spheres[i];
        for (const float difference : {a.x - b.x, a.y - b.y, a.z - b.z, a.radius - b.radius}) {
          worst = std::max(worst, std::abs(static_cast<double>(difference)));
        }
      }
    }
  }
  return worst / bake.regions.frame.height;
}

std::vector<Deformation> frames_of(const Motion& motion, int count) {
  std::vector<Deformation> out;
  for (int i = 0; i < count; ++i) out.push_back(motion.at(i / std::max(1.0, count - 1.0)));
  return out;
}

std::vector<Deformation> frames_of_clips(const SourceRig& rig) {
  std::vector<Deformation> out;
  for (const Clip& clip : rig.clips) {
    const std::vector<Deformation> frames = frames_of(ClipMotion(rig, {&clip}), 25);
    out.insert(out.end(), frames.begin(), frames.end());
  }
  return out;
}

}  // namespace

TEST_CASE("on the automatic rig, along Bezier curves of poses, bones give the spheres of the skinned mesh" *
          doctest::test_suite("many bakes")) {
  const Bake& bake = baked_human();
  std::vector<Deformation> frames;
  for (const char* name : {"animation_arms.json", "animation_legs.json", "hands_on_hips.json", "deep_squat.json"}) {
    const PoseMotion poses = read_pose_motion(std::string(SPHERECHAIN_SAMPLES) + "/poses/" + name, bake.joints);
    const auto more = frames_of(BezierMotion(bake.joints, bake.regions.frame, poses), 40);
    frames.insert(frames.end(), more.begin(), more.end());
  }
  const double worst = worst_difference(bake, frames);
  MESSAGE(fmt::format("{} frames: {:.2g} of the height", frames.size(), worst));
  CHECK(worst < kTolerance);
}

TEST_CASE("on a source's own skeleton, over its clips, bones give the spheres of the skinned mesh") {
  const Bake& bake = baked_person();
  REQUIRE(!bake.character.rig.clips.empty());
  const std::vector<Deformation> frames = frames_of_clips(bake.character.rig);
  const double worst = worst_difference(bake, frames);
  MESSAGE(fmt::format("{} frames: {:.2g} of the height", frames.size(), worst));
  CHECK(worst < kTolerance);
}

TEST_CASE("morph targets move no sphere: bones give those of the skinned mesh without them") {
  const Bake& bake = morphing_person();
  const spherechain::baker::OpenAsset asset = open_asset_of(bake);
  REQUIRE(asset->morph_count() == 3);
  CHECK(std::string(asset->morph_name(1)) == "grows 1");
  REQUIRE(asset->bone(asset->bone_count() - 1).is_rest);
  CHECK(worst_difference(bake, frames_of_clips(bake.character.rig)) < kTolerance);
}

TEST_CASE("the bones of an asset are the source's in order, or the automatic rig's") {
  const spherechain::baker::OpenAsset human = open_asset_of(baked_human()), person = open_asset_of(baked_person());
  REQUIRE(human->bone_count() == baked_human().joints.size());
  for (std::size_t b = 0; b < human->bone_count(); ++b) {
    CHECK(human->bone(b).name == baked_human().joints[b].name);
    CHECK(human->bone(b).inverse_bind[3] == static_cast<float>(-baked_human().joints[b].position.x()));
    CHECK(human->bone(b).inverse_bind[0] == 1);
  }
  const SourceRig& rig = baked_person().character.rig;
  REQUIRE(person->bone_count() == rig.bones.size());
  for (std::size_t b = 0; b < rig.bones.size(); ++b) {
    CHECK(person->bone(b).name == rig.nodes[rig.bones[b].node].name);
    CHECK(person->bone(b).inverse_bind[7] == static_cast<float>(rig.bones[b].inverse_bind.translation().y()));
  }
}

TEST_CASE("characters of SPHERECHAIN_TEST_DATA: over every clip bones give the spheres of the skinned mesh") {
  for_each_test_character([](const Bake& bake) {
    const std::vector<Deformation> frames = frames_of_clips(bake.character.rig);
    const double worst = worst_difference(bake, frames);
    MESSAGE(fmt::format("{}: {} frames: {:.2g} of the height", bake.character.file, frames.size(), worst));
    CHECK(worst < kTolerance);
  });
}
