// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <numbers>
#include <optional>
#include <vector>

#include "baker/import/moved_nodes.h"
#include "baker/motion/clip.h"

namespace spherechain::baker {

constexpr double to_radians(double degrees) { return degrees * std::numbers::pi / 180; }
constexpr double to_degrees(double radians) { return radians * 180 / std::numbers::pi; }

// The range of an elbow or a knee in radians. 0: straight.
struct Hinge {
  Vec3 axis;          // in the joint's own axes
  Vec3 upper, lower;  // along the bones: `upper` in the parent's axes, `lower` in the joint's
  double min_bend = 0, max_bend = 0;

  double bend(const Eigen::Quaterniond& rotation) const;
};

// A joint that a fix may turn.
struct TurningJoint {
  Index node;
  Eigen::Matrix3d cost = Eigen::Matrix3d::Identity();  // a turn x, in the joint's own axes, costs x' * cost * x
  std::optional<Hinge> hinge;
};

// Rotation vectors in the joints' own axes, in radians: all joints of frame 0, then of frame 1, ...
using Turns = std::vector<Vec3>;

// Derivative D of a turn: turning by x + d equals turning by x, then by D * d, to first order.
Eigen::Matrix3d turn_derivative(const Vec3& x);
// A node's rotation in a clip.
Eigen::Quaterniond rotation_at(const SourceRig& rig, const Clip& clip, Index node, double seconds);
Eigen::Quaterniond turned(const Eigen::Quaterniond& rotation, const Vec3& x);

// A clip whose joints can be turned in addition to their animation.
class TurnedClip {
 public:
  // `rig` and `clip` must outlive it. Frames lie at number / fps seconds.
  TurnedClip(const SourceRig& rig, const Clip& clip, double fps, int frames, std::vector<TurningJoint> joints);

  struct Pose {
    Deformation deformation;
    std::vector<Affine> axes;  // by turning joint, without its scale: to the rest pose's space
  };
  // `frame` may have a fraction; turns are then blended.
  Pose pose(double frame, const Turns& turns) const { return pose_of(frame, turns_at(frame, turns)); }
  Pose pose_of(double frame, const std::vector<Vec3>& turns) const;  // by joint

  const SourceRig& rig() const { return rig_; }
  const Clip& clip() const { return clip_; }
  double fps() const { return fps_; }
  int frames() const { return frames_; }
  const std::vector<TurningJoint>& joints() const { return joints_; }
  std::size_t count() const { return joints_.size(); }
  // The turning joints that move a bone or a turning joint, including itself.
  const std::vector<Index>& above(Index bone) const { return above_[bone]; }
  std::vector<Index> above_joint(Index joint) const { return joints_above(joints_[joint].node); }
  // The bend of a joint with a hinge in a whole frame of the source clip, in radians.
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
  std::vector<std::vector<Eigen::Quaterniond>> rotations_;  // by joint (with a hinge), then by frame
};

// Derivative of the position `at` by the turn of a joint, linearised at the turn x.
Eigen::Matrix3d turn_moves(const Affine& axes, const Vec3& at, const Vec3& x);

// A point of the skin in barycentric coordinates of a triangle.
struct SkinSpot {
  std::array<Index, 3> vertices{};
  std::array<double, 3> shares{};
};

// The position of a skin point and its derivatives by the turns of the joints that move it. Column k of a matrix is the
// derivative along axis k.
struct SpotMotion {
  Vec3 at = Vec3::Zero();
  std::vector<std::pair<Index, Eigen::Matrix3d>> by_joint;
};
SpotMotion motion_of(const TurnedClip& clip, const TurnedClip::Pose& pose, const std::vector<Vec3>& rest,
                     const std::vector<VertexWeights>& weights, const SkinSpot& spot, const Vec3* turns);

}  // namespace spherechain::baker
