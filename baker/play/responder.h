// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/play/arm_meter.h"
#include "baker/play/bone_joints.h"
#include "spherechain/response.h"

namespace spherechain::baker {

// Plays the frames of a motion through the runtime's response, as a game does. The asset's bones must move it.
class Responder {
 public:
  // `ahead`: so many frames are known in advance. `other`: the largest asset that it will meet; null: none is larger
  // than its own. Throws Error(kFile) where the asset has no arms, or where bones do not move it.
  Responder(const AnimatedAsset& animated, Target target, int ahead, const OpenAsset* other = nullptr);

  struct Corrected {
    Deformation animated, corrected;
    bool is_turned;  // else both are the same
    bool starts_clip;
    double us;  // processor time of the response
  };
  // The corrected pose of a frame. Frames come in their order; each clip starts afresh. `place`: where the character
  // stands; null: where it is animated. `other`: a body to stay out of; null: none.
  Corrected correct(int frame, const sc_transform* place = nullptr, const Body* other = nullptr);
  // The same, measured.
  Deformation respond(int frame);
  ResponseMeasures measures() const { return tally_.measures(); }
  // In the pose that was corrected last.
  Body& body() { return body_; }

 private:
  std::vector<sc_transform> joints_at(const MotionFrame& frame) const;

  const AnimatedAsset& animated_;
  Target target_;
  int ahead_;
  BoneJoints joints_;
  ArmMeter meter_;
  ResponseTally tally_;
  Body body_;
  Response response_;
  ResponseState state_;
};

}  // namespace spherechain::baker
