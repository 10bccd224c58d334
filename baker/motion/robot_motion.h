// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "baker/motion/capture.h"

namespace spherechain::baker {

// A robot's motion as numbers: frame by frame.
struct RobotFrames {
  std::vector<double> seconds;  // ascending
  // The place of the robot's root in the world: x, y, z and a quaternion x, y, z, w. Empty: it stays.
  std::vector<std::array<double, 7>> roots;
  std::vector<Index> joints;                // of the robot: a value of each is in a frame; others stay at their zero
  std::vector<std::vector<double>> values;  // radians or metres
};

// The motion of the robot's nodes. Joints that mimic others follow them. A note says which joints go beyond their
// limits. `file` is for messages.
Clip clip_of_robot(const SourceRig& rig, const RobotFrames& frames, const std::string& file);

// Frames from rows of numbers: the root's place (3) and quaternion (x, y, z, w), then a value of each joint that is
// neither fixed nor mimics another, in the order of the robot's file. Throws Error(kFile) that begins with `file` where
// a row has another count of numbers. Rows without a root are for robots that stay in place.
RobotFrames frames_of_rows(const SourceRig& rig, const std::vector<std::vector<double>>& rows, double fps,
                           const std::string& file);

// Frames a second of rows without times: LAFAN1's.
inline constexpr double kRobotFps = 30;

// Reads a motion as CSV (docs/robots.md), rows as above or with a header that names joints, or the tables of research
// data (import/robot_motion.h). Throws Error(kFile).
Capture read_robot_motion(const std::filesystem::path& file, const SourceRig& rig);

}  // namespace spherechain::baker
