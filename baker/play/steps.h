// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <vector>

#include "baker/play/bone_joints.h"
#include "baker/play/play.h"
#include "spherechain/contacts.h"

namespace spherechain::baker {

// Finds contacts on the way from one deformation to the next. Joints turn as engines blend poses, down the skeleton.
// Whole meshes as poses, and skin on sheared bones, move straight. The asset must have clusters, and `animated` must
// outlive this object.
class StepPlayer {
 public:
  StepPlayer(const AnimatedAsset& animated, Target target);

  // Sorted by body parts; holds until the next call.
  const std::vector<StepContact>& find(const Deformation& from, const Deformation& to);

 private:
  const AnimatedAsset& animated_;
  Target target_;
  BoneJoints joints_;
  std::vector<std::uint64_t> scratch_;
  std::vector<StepContact> contacts_;
};

// Inserts a frame between two of a clip's own if body parts touch only between them, about where they are deepest:
// MotionFrame::between. `progress` is called with each frame.
void look_between_frames(AnimatedAsset& animated, Target target, std::size_t clip,
                         const std::function<void(int)>& progress);
// Adds the contacts between frames, for all clips that play.
void look_between_frames(AnimatedAsset& animated, Target target, const std::function<void(int)>& progress);

}  // namespace spherechain::baker
