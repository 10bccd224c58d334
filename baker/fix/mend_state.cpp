// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/mend_state.h"

#include "baker/fix/constraints.h"
#include "baker/fix/joints.h"
#include "baker/motion/same_pose.h"

namespace spherechain::baker {
namespace {

bool is_loop(const TurnedClip& clip, const BodyFrame& frame) {
  const Turns none(static_cast<std::size_t>(clip.frames()) * clip.count(), Vec3::Zero());
  return same_pose(clip.pose(0, none).deformation, clip.pose(clip.frames() - 1, none).deformation, frame);
}

}  // namespace

ClipFacts clip_facts(const AnimatedAsset& animated, const Roles& roles, const ClipFrames& frames,
                     const MendOptions& options) {
  const SourceRig& rig = animated.character().rig;
  const double height = animated.frame().height;
  TurnedClip clip(rig, *frames.clip, frames.fps, frames.own_count, turning_joints(rig, roles, *frames.clip));
  std::vector<Index> feet = joints_of_role(clip.joints(), roles, "ankle");
  std::vector<Index> wrists = joints_of_role(clip.joints(), roles, "wrist");
  std::vector<std::vector<Index>> planted = planted_hands(clip, wrists, feet, animated.frame().up, height);
  std::vector<char> hands_joined(static_cast<std::size_t>(clip.frames()), 0);
  if (wrists.size() == 2) hands_joined = frames_with_joined_hands(clip, wrists[0], wrists[1], height);
  PartJoints parts(animated, clip, feet);
  const bool loops = is_loop(clip, animated.frame());
  return {animated,
          options,
          mm_per_unit(animated.asset()),
          height,
          std::move(clip),
          std::move(feet),
          std::move(wrists),
          std::move(planted),
          std::move(hands_joined),
          std::move(parts),
          loops};
}

}  // namespace spherechain::baker
