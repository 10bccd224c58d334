// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "baker/motion/motion.h"
#include "baker/rig/rig.h"
#include "baker/segment/body_plan.h"

namespace spherechain::baker {

// Rotations of joints from the rest pose, in the character's own axes (x left, y up, z forward), about each joint's
// position, applied before the rotation of its parent. A joint that does more than turn has a movement instead, with
// the character's height as the unit.
struct Pose {
  std::map<std::string, Eigen::Quaterniond> rotations;
  std::map<std::string, Affine> movements;
  std::map<std::string, double> morphs;  // weights; of those that are not named 0
};

// A motion that starts at rest and goes through poses, evenly spaced.
struct PoseMotion {
  std::string name;
  std::vector<Pose> poses;
};

// The rig whose joints a pose file names.
enum class PoseRig { kAutomatic, kOwn };

// Throws Error(kFile) that names the file and the cause.
PoseRig rig_of_poses(const std::filesystem::path& path);

// Reads a pose file (docs/formats.md). Throws Error(kFile) that names the file and the cause; names are checked against
// `joints` and `morphs`.
PoseMotion read_pose_motion(const std::filesystem::path& path, const std::vector<Joint>& joints,
                            const std::vector<Morph>& morphs = {});

// A pose file and the files that it includes, as far as they can be read.
std::vector<std::filesystem::path> files_of_poses(const std::filesystem::path& path);

// The joints of a character's own skeleton: one for each bone, in their order, so parents need not come first. Names
// are those of the nodes; what another joint is called already gets a number.
std::vector<Joint> own_joints(const SourceRig& rig);

// The transform of each joint in a pose, parents included. Exactly the identity for joints that nothing turns.
std::vector<Affine> bones_of(const std::vector<Joint>& joints, const BodyFrame& frame, const Pose& pose);

// The animation of the paper's section 5.1: quadratic Bezier interpolation of the vertices between poses. A vertex is
// linear in the bones, so its curve is that of the bones' matrices. It starts at rest and ends in the last pose.
// Weights of `morphs` go straight from pose to pose.
class BezierMotion : public Motion {
 public:
  BezierMotion(const std::vector<Joint>& joints, const BodyFrame& frame, const PoseMotion& motion,
               const std::vector<Morph>& morphs = {});
  Deformation at(double t) const override;

 private:
  std::vector<std::vector<Affine>> keys_;    // rest, control, pose 0, control, pose 1, ...: a curve has three of them
  std::vector<std::vector<double>> morphs_;  // rest, pose 0, pose 1 ...
};

}  // namespace spherechain::baker
