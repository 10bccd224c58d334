// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "baker/import/arrays.h"
#include "baker/import/source_rig.h"

namespace spherechain::baker {

// A robot's motion: its root in the world, z up in metres, and the value of each of its joints, in a frame each.
struct RobotMotion {
  double fps = 0;
  std::vector<Vec3> root_positions;
  std::vector<Eigen::Quaterniond> root_rotations;
  std::size_t joint_count = 0;
  std::vector<double> joint_values;      // frame by frame; radians or metres, in the order of the robot's file
  std::vector<std::string> joint_names;  // empty where the file has none

  std::size_t frames() const { return root_positions.size(); }
  const double* values(std::size_t frame) const { return joint_values.data() + frame * joint_count; }
};

// The motion in the tables of GMR ('fps', 'root_pos', 'root_rot' with w last, 'dof_pos') or of PHC and HumanoidVerse
// ('root_trans_offset', 'root_rot', 'dof'). 'dof_names' or 'joint_names'
// name the joints. Nothing where the tables hold no such motion. Adds a note (notes.h) where the file has w first, or
// names no frame rate. Throws Error(kFile) that begins with `file` where the tables do not fit each other.
std::optional<RobotMotion> robot_motion(const Arrays& arrays, const std::string& file);

// Reads such tables of an .npz or a pickle in a child process. Throws Error(kFile), also where there is no such motion.
RobotMotion read_robot_arrays(const std::filesystem::path& path);

}  // namespace spherechain::baker
