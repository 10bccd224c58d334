// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "rig/rig.h"
#include "segment/body_plan.h"

namespace spherechain::baker {

// Rotations of joints from the rest pose, in the character's own axes (x left, y up, z forward), about each joint's
// position, applied before the rotation of its parent.
struct Pose {
  std::map<std::string, Eigen::Quaterniond> rotations;
};

// A motion that starts at rest and goes through poses, evenly spaced.
struct PoseMotion {
  std::string name;
  std::vector<Pose> poses;
};

// Reads a pose file (samples/poses/README.md). Throws Error(kFile) that names the file and the cause; joint names are
// checked against `joints`.
PoseMotion read_pose_motion(const std::filesystem::path& path, const std::vector<Joint>& joints);

// x -> rotation x + translation, in the mesh's axes and units.
struct JointTransform {
  Eigen::Matrix3d rotation;
  Vec3 translation;
};

// A transform a joint, its parents' included: the bone matrices of a pose. Exactly none for a joint that nothing turns.
std::vector<JointTransform> joint_transforms(const std::vector<Joint>& joints, const BodyFrame& frame,
                                             const Pose& pose);

// Linear blend skinning of the rest positions. `rest` and `weights` have the same length and order.
std::vector<Vec3> skin(const std::vector<Vec3>& rest, const std::vector<VertexWeights>& weights,
                       const std::vector<Joint>& joints, const BodyFrame& frame, const Pose& pose);

// The animation of the paper's section 5.1: quadratic Bezier interpolation of the vertices between poses. Frame 0 is
// the rest pose, the last frame the last pose.
class BezierMotion {
 public:
  BezierMotion(const std::vector<Vec3>& rest, const std::vector<VertexWeights>& weights,
               const std::vector<Joint>& joints, const BodyFrame& frame, const PoseMotion& motion);
  // Positions at t in [0, 1].
  std::vector<Vec3> at(double t) const;

 private:
  std::vector<std::vector<Vec3>> keys_;  // rest, control, pose 0, control, pose 1 ...: a stretch is three of them
};

}  // namespace spherechain::baker
