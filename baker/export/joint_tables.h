// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "baker/export/formats.h"
#include "baker/play/play.h"

// The joint angles of clips beside a robot's file: with them the robot's bodies stand where the clip has them.
namespace spherechain::baker {

// Where each body stands in each frame of a clip, in the axes of the rest pose, in metres.
struct PosedClip {
  std::string name;
  std::vector<double> seconds;
  std::vector<std::vector<Eigen::Isometry3d>> frames;
};

// The clips that play. Empty where no bones move the asset.
std::vector<PosedClip> posed_clips(const AnimatedAsset& animated, const Colliders& colliders);

// Sets how far clips turn bodies in their parents, and lets bodies slide that the clips move in their parents: where a
// bone stretches or travels, or where bones without a part of their own lie between two parts. The note names them;
// empty: there are none.
std::string allow_motion(const std::vector<PosedClip>& clips, Colliders& colliders);

// A CSV for each clip: `time` in seconds, then a column for each joint of the robot's file. A ball joint of MJCF has
// four columns, its quaternion; a free joint has its place before.
std::vector<ExportFile> mjcf_joint_tables(const Colliders& colliders, const std::vector<PosedClip>& clips);
std::vector<ExportFile> urdf_joint_tables(const Colliders& colliders, const std::vector<PosedClip>& clips);

}  // namespace spherechain::baker
