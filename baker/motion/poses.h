// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "motion/motion.h"
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

// A pose file and the files that it includes, as far as they can be read.
std::vector<std::filesystem::path> files_of_poses(const std::filesystem::path& path);

// The transform of each joint in a pose, parents included. Exactly the identity for joints that nothing turns.
std::vector<Affine> bones_of(const std::vector<Joint>& joints, const BodyFrame& frame, const Pose& pose);

// The animation of the paper's section 5.1: quadratic Bezier interpolation of the vertices between poses. A vertex is
// linear in the bones, so its curve is that of the bones' matrices. It starts at rest and ends in the last pose.
class BezierMotion : public Motion {
 public:
  BezierMotion(const std::vector<Joint>& joints, const BodyFrame& frame, const PoseMotion& motion);
  Deformation at(double t) const override;

 private:
  std::vector<std::vector<Affine>> keys_;  // rest, control, pose 0, control, pose 1, ...: a curve has three of them
};

}  // namespace spherechain::baker
