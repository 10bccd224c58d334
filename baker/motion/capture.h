// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "motion/motion.h"
#include "motion/role_joints.h"
#include "segment/body_plan.h"

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

// The body a capture moves: its joints by role, at rest, and which of them each bone of its skin goes with.
struct CaptureBody {
  BodyFrame frame;
  RoleJoints joints;
  std::vector<Index> joint_of_bone;
};
CaptureBody body_of(const std::vector<Joint>& joints, const BodyFrame& frame);  // a bone each
// Throws Error(kFile) that begins with `file` where the skin's skeleton is not that of a biped.
CaptureBody body_of(const SourceRig& rig, const std::vector<Vec3>& rest, const BodyFrame& frame,
                    const std::string& file);

// A capture on a body of other proportions and another rest pose. Arms and legs are turned so that they are parallel to
// the capture's while it rests, and from there on every joint turns as the capture's joint of the same role does; a
// joint the capture has not stays straight. The pelvis travels in proportion to the legs, from where the body stands
// and faces at rest; the feet come down to where they rest.
class CaptureMotion : public Motion {
 public:
  // Throws Error(kFile) where the capture has no legs or no neck.
  CaptureMotion(Capture capture, CaptureBody body);
  Deformation at(double t) const override;
  double duration() const override { return capture_.clip.duration; }

 private:
  // What a joint of the body does: it turns as a node of the capture; with none, as its parent.
  struct Follower {
    int source = -1;
    Eigen::Matrix3d from_rest = Eigen::Matrix3d::Identity();  // the body at rest -> the node's own axes
  };
  void align(const RoleJoints& reference, const std::vector<Affine>& world, const Eigen::Matrix3d& axes);
  double lift() const;
  std::vector<Affine> joints_at(double t) const;

  Capture capture_;
  CaptureBody body_;
  Eigen::Matrix3d to_body_;  // from the space the capture moves in to that of the body
  std::vector<Follower> followers_;
  std::array<Index, 2> hips_;  // nodes of the capture
  Vec3 anchor_, start_;        // the middle of the hips: the body's at rest, the capture's when it starts
  double stride_, lift_ = 0;   // the body's leg length over the capture's; what brings the feet down
};

// What plays `file` on a character with a skin of its own: its clip by the names of its nodes where it has the skin's
// very skeleton, and else by roles.
std::unique_ptr<Motion> capture_motion(const std::filesystem::path& file, const SourceRig& rig,
                                       const std::vector<Vec3>& rest, const BodyFrame& frame,
                                       const std::string& character);

}  // namespace spherechain::baker
