// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "baker/play/bone_joints.h"
#include "baker/play/skin_player.h"
#include "spherechain/response.h"

namespace spherechain::baker {

// How a motion changes by the response. Times are in microseconds, lengths shares of the height; a fault is an arm's
// that is at least 3 mm deep on a human of 1.75 m, between parts that do not hang on each other.
struct ResponseMeasures {
  int frames = 0, faulty_before = 0, faulty_after = 0;
  int new_faults = 0;             // frames with a fault of two parts that have none in the animation
  double wrist_acceleration = 1;  // after over before, root mean square
  double elbow_acceleration = 1;
  double largest_jump = 0;         // beyond the animation's, of a wrist or an elbow from frame to frame
  double moved_without_fault = 0;  // of the frames without a fault the share where a wrist moves by .3 %
  double residual_p95 = 0;         // depth of the deepest fault
  double us_mean = 0, us_p99 = 0;
};

// Plays the frames of a motion through the runtime's response, as a game does. The asset's bones must move it.
class Responder {
 public:
  // `ahead`: so many frames are known in advance. Throws Error(kFile) where the asset has no arms, or where bones do
  // not move it.
  Responder(const AnimatedAsset& animated, Target target, int ahead);

  // The corrected pose of a frame. Frames come in their order; each clip starts afresh.
  Deformation respond(int frame);
  ResponseMeasures measures() const;

 private:
  // Places of wrists and elbows.
  struct Ends {
    std::vector<Vec3> wrists, elbows;
  };
  // In a frame, before and after.
  struct Frame {
    bool is_faulty_before, is_faulty_after, is_new, starts_clip;
    double depth;
    Ends before, after;
    double us;
  };
  std::vector<sc_transform> joints_at(const MotionFrame& frame) const;
  Ends ends_of(const Deformation& deformation) const;
  std::vector<Penetration> faults_of(const Deformation& deformation);

  const AnimatedAsset& animated_;
  Target target_;
  int ahead_;
  BoneJoints joints_;
  std::vector<bool> is_arm_;                  // by body part
  std::vector<std::size_t> wrists_, elbows_;  // bones
  Body body_;
  Response response_;
  ResponseState state_;
  SkinPlayer judge_;
  std::vector<Frame> frames_;
};

}  // namespace spherechain::baker
