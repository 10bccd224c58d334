// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "import/moved_nodes.h"
#include "motion/clip.h"

namespace spherechain::baker {

// An elbow or a knee: how far it bends. Radians; 0: straight.
struct Hinge {
  Vec3 axis;          // in the joint's own axes, as the lower bone
  Vec3 upper, lower;  // along the bones: of the upper one in the parent's axes
  double least = 0, most = 0;

  double bend(const Eigen::Quaterniond& rotation) const;
};

// A joint that a mend may turn.
struct TurningJoint {
  Index node;
  Eigen::Matrix3d price = Eigen::Matrix3d::Identity();  // a turn x, in the joint's own axes, costs x' price x
  std::optional<Hinge> hinge;
};

// Rotation vectors, in the joints' own axes: radians, a joint's after the other's, frame by frame.
using Turns = std::vector<Vec3>;

// Derivative of a turn: turning by x + d is turning by x, then by this times d, to first order.
Eigen::Matrix3d turn_derivative(const Vec3& x);
// A node's rotation in a clip.
Eigen::Quaterniond rotation_at(const SourceRig& rig, const Clip& clip, Index node, double seconds);
Eigen::Quaterniond turned(const Eigen::Quaterniond& rotation, const Vec3& x);

// A clip with joints turned on top of what it does.
class TurnedClip {
 public:
  // `rig` and `clip` must outlive it. Frames lie at number / fps seconds.
  TurnedClip(const SourceRig& rig, const Clip& clip, double fps, int frames, std::vector<TurningJoint> joints);

  struct Pose {
    Deformation deformation;
    std::vector<Affine> axes;  // of each turning joint, before its scale: to the rest pose's space
  };
  // `frame` may have a fraction: turns are blended.
  Pose pose(double frame, const Turns& turns) const { return pose_of(frame, turns_at(frame, turns)); }
  Pose pose_of(double frame, const std::vector<Vec3>& turns) const;  // of each joint

  const SourceRig& rig() const { return rig_; }
  const Clip& clip() const { return clip_; }
  double fps() const { return fps_; }
  int frames() const { return frames_; }
  const std::vector<TurningJoint>& joints() const { return joints_; }
  std::size_t count() const { return joints_.size(); }
  // The turning joints that move a bone, or a turning joint, itself among them.
  const std::vector<Index>& above(Index bone) const { return above_[bone]; }
  std::vector<Index> above_joint(Index joint) const { return joints_above(joints_[joint].node); }
  // How far a joint with a hinge is bent in a whole frame of the clip.
  double bend(int frame, Index joint) const {
    return joints_[joint].hinge->bend(rotations_[joint][static_cast<std::size_t>(frame)]);
  }
  // Clamps a turn in a whole frame: to `most` radians, and to a little more than the hinge's range.
  Vec3 within_limits(int frame, Index joint, Vec3 turn, double most) const;
  // The turn of each joint. Between two frames, turns are blended.
  std::vector<Vec3> turns_at(double frame, const Turns& turns) const;

 private:
  std::vector<Index> joints_above(Index node) const;

  const SourceRig& rig_;
  const Clip& clip_;
  double fps_;
  int frames_;
  std::vector<TurningJoint> joints_;
  std::vector<int> joint_of_node_, joint_at_or_above_;
  MovedNodes moved_;
  std::vector<std::vector<Index>> above_;
  std::vector<std::vector<Eigen::Quaterniond>> rotations_;  // of a joint with a hinge: by frame
};

// How a turn of a joint moves what is at `at`: by this times the turn, to first order around the turn x.
Eigen::Matrix3d turn_moves(const Affine& axes, const Vec3& at, const Vec3& x);

// A point of the skin: shares of a triangle's corners.
struct SkinSpot {
  std::array<Index, 3> vertices{};
  std::array<double, 3> shares{};
};

// Where it is, and how it moves with each turning joint: column 3 j + k is by what the turn of joint j along k moves
// it.
struct SpotMotion {
  Vec3 at = Vec3::Zero();
  std::vector<std::pair<Index, Eigen::Matrix3d>> by_joint;
};
SpotMotion motion_of(const TurnedClip& clip, const TurnedClip::Pose& pose, const std::vector<Vec3>& rest,
                     const std::vector<VertexWeights>& weights, const SkinSpot& spot, const Vec3* turns);

}  // namespace spherechain::baker
