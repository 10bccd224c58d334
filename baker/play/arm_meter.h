// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

#include "baker/play/bone_joints.h"
#include "baker/play/skin_player.h"

namespace spherechain::baker {

// How a motion changes when arms are kept out of the body. Times are in microseconds, lengths shares of the height; a
// fault is an arm's that is at least 3 mm deep on a human of 1.75 m, between parts that do not hang on each other.
struct ResponseMeasures {
  int frames = 0, faulty_before = 0, faulty_after = 0;
  int new_faults = 0;             // frames with a fault of two parts that have none in the animation
  double wrist_acceleration = 1;  // after over before, root mean square
  double elbow_acceleration = 1;
  double largest_jump = 0;         // beyond the animation's, of a wrist or an elbow from frame to frame
  double moved_without_fault = 0;  // of the frames without a fault the share where a wrist moves by .3 %
  // Frames in which a wrist's correction peaks or dips, by .3 % against the frame before and after.
  int flickers = 0;
  double residual_p95 = 0;  // depth of the deepest fault
  double us_mean = 0, us_p99 = 0;
};

// Is a body part of an arm, by its name?
bool is_of_arm(std::string_view part);
// Is a penetration a fault that counts: 3 mm deep or more on a human?
bool is_deep_fault(const Penetration& found);

// The arms of a character in a pose.
struct ArmPose {
  std::vector<Penetration> faults;
  std::vector<Vec3> wrists, elbows;  // where these joints are
};

// Measures the arms of a character, pose by pose, in full.
class ArmMeter {
 public:
  // The asset must outlive it. Throws Error(kFile) where the asset has no arms, or where bones do not move it.
  ArmMeter(const AnimatedAsset& animated, Target target);
  ArmPose look_at(const Deformation& deformation);

 private:
  const AnimatedAsset& animated_;
  BoneJoints joints_;
  SkinPlayer skin_;
  std::vector<bool> is_arm_;                  // by body part
  std::vector<std::size_t> wrists_, elbows_;  // bones
};

// Compares a motion's poses, frame by frame, with those that somebody made of them.
class ResponseTally {
 public:
  explicit ResponseTally(double height) : height_(height) {}
  void add(const ArmPose& before, const ArmPose& after, double us, bool starts_clip);
  ResponseMeasures measures() const;

 private:
  struct Frame {
    bool is_faulty_before, is_faulty_after, is_new, starts_clip;
    double depth;
    std::vector<Vec3> ends[2][2];  // wrists and elbows, before and after
    double us;
  };
  double height_;
  std::vector<Frame> frames_;
};

}  // namespace spherechain::baker
