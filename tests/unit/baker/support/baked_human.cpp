// SPDX-License-Identifier: GPL-3.0-or-later
#include "baked_human.h"

#include "baker/motion/poses.h"
#include "human.h"

using namespace spherechain::baker;

namespace {

const std::vector<VertexWeights>& human_weights() {
  const Bake& bake = baked_human();
  static const std::vector<VertexWeights> weights = rig_weights(bake.character, bake.regions.body, bake.joints);
  return weights;
}

std::vector<Vec3> human_at(const std::string& pose_file, double t) {
  const Bake& bake = baked_human();
  const PoseMotion poses = read_pose_motion(std::string(SPHERECHAIN_SAMPLES) + "/poses/" + pose_file, bake.joints);
  const BezierMotion motion(bake.joints, bake.regions.frame, poses);
  return deform(bake.character.source_positions, human_weights(), motion.at(t).bones);
}

}  // namespace

const Bake& baked_human() {
  static const Bake result = bake(kHumanFile, make_settings("balanced", "{}", "test"), {});
  return result;
}

const Bake& paper_baked_human() {
  static const Bake result = bake(kHumanFile, make_settings("paper", "{}", "test"), {});
  return result;
}

OpenAsset open_asset_of(const Bake& bake) {
  return OpenAsset({reinterpret_cast<const char*>(bake.asset.data()), bake.asset.size()}, "baked");
}

const std::vector<AnimationFrame>& animation_frames() {
  static const std::vector<AnimationFrame> frames = [] {
    std::vector<AnimationFrame> out;
    for (const char* name : {"animation_arms.json", "animation_legs.json"}) {
      for (int i = 0; i < 40; ++i) out.push_back({name, i, human_at(name, i / 39.0)});
    }
    return out;
  }();
  return frames;
}

std::vector<Vec3> posed_human(const std::string& pose_file) { return human_at(pose_file, 1); }
