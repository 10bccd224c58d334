// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "baker/play/play.h"

namespace spherechain::baker {

// A limb to drag by its end, and by the joint between: an arm from the upper arm to the hand. Joints by number.
struct PosableLimb {
  std::string end_name, middle_name;  // "left hand", "left elbow"
  int upper = -1, middle = -1, end = -1;
  Vec3 tip;             // what is dragged, at rest; it moves with `end`
  bool stands = false;  // a leg: its end stays where it is while the hips move
};

// The part of a character that can be posed by hand: the joints that move its skin, which a pose file names, and
// handles on them.
struct PosableRig {
  PoseRig rig = PoseRig::kOwn;
  std::vector<Joint> joints;  // one for each of the asset's bones that has a name, in their order
  std::vector<PosableLimb> limbs;
  int hips = -1, neck = -1, head = -1;  // -1: none. The head is turned at the neck
  Vec3 head_center = Vec3::Zero();      // of its skin, at rest
};

// Finds the joints that move the skin now. No joints if the bones of the asset do not move it.
PosableRig posable_rig(const AnimatedAsset& animated);

}  // namespace spherechain::baker
