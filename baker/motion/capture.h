// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "baker/motion/motion.h"
#include "baker/motion/role_joints.h"
#include "baker/segment/body_plan.h"

namespace spherechain::baker {

// A recorded motion: a skeleton in its rest pose, and how it moves.
struct Capture {
  std::string file;  // for messages
  SourceRig rig;
  Clip clip;
  std::vector<std::string> roles;  // of the rig's nodes
};

// The longest clip of a BVH, FBX, Collada or any other file with one, with roles by name and shape.
// Throws Error(kFile).
Capture read_capture(const std::filesystem::path& file);

// The body that a capture moves: its joints by role, at rest, and the joint that each bone of its skin follows.
struct CaptureBody {
  BodyFrame frame;
  RoleJoints joints;
  std::vector<Index> joint_of_bone;
};
// Both throw Error(kFile) that begins with `file` and says what the body lacks where it has no two legs.
// The roles of the automatic rig's joints, which are a bone each; none where the body is no biped.
CaptureBody body_of(const std::vector<Joint>& joints, const BodyFrame& frame, const std::string& file);
// Makes a capture body of the skin's own skeleton.
CaptureBody body_of(const SourceRig& rig, const std::vector<Vec3>& rest, const BodyFrame& frame,
                    const std::string& file);

// Plays a capture on a body of other proportions and another rest pose. First arms and legs are turned parallel to
// those of the resting capture. Then every joint turns as the capture's joint of the same role does; joints that the
// capture lacks stay straight. The pelvis starts where the body stands and travels in proportion to its legs; feet
// reach the ground where they do at rest.
class CaptureMotion : public Motion {
 public:
  // Throws Error(kFile) where the capture has no legs or no neck.
  CaptureMotion(Capture capture, CaptureBody body);
  Deformation at(double t) const override;
  double duration() const override { return capture_.clip.duration; }
  double rate() const override;
  int frame_count() const override { return duration() > 0 ? 0 : 1; }  // of one pose

  const Capture& capture() const { return capture_; }
  const CaptureBody& body() const { return body_; }
  // How each of the body's joints has moved since rest.
  std::vector<Affine> joints_at(double t) const;
  const std::array<Index, 2>& hips() const { return hips_; }  // nodes of the capture
  // The node of the capture that a joint turns with, -1 none; and how that node is turned in its own space when the
  // joint is turned so from rest.
  int source(Index joint) const { return followers_[joint].source; }
  Eigen::Matrix3d source_rotation(Index joint, const Eigen::Matrix3d& turned) const;

 private:
  // The node of the capture that a joint turns with; without one it turns with its parent.
  struct Follower {
    int source = -1;
    Eigen::Matrix3d from_rest = Eigen::Matrix3d::Identity();  // the body at rest -> the node's own axes
  };
  void align(const RoleJoints& reference, const std::vector<Affine>& world, const Eigen::Matrix3d& axes);
  double lift() const;

  Capture capture_;
  CaptureBody body_;
  Eigen::Matrix3d to_body_;  // from the space the capture moves in to that of the body
  std::vector<Follower> followers_;
  std::array<Index, 2> hips_;  // nodes of the capture
  Vec3 anchor_, start_;        // the middle of the hips: the body's at rest, the capture's when it starts
  double stride_, lift_ = 0;   // the body's leg length over the capture's; what brings the feet down
};

}  // namespace spherechain::baker
