// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <map>
#include <string>
#include <vector>

#include "baker/import/bvh_file.h"

namespace spherechain::baker {

// The text of a BVH file whose joints can be turned. Every other byte stays, except a wrong number of frames.
class BvhText {
 public:
  // `file` is for messages. Throws Error(kFile) as parse_bvh does.
  BvhText(std::string text, const std::string& file);

  const std::vector<BvhJoint>& joints() const { return bvh_.joints; }
  int frames() const { return static_cast<int>(bvh_.frames()); }
  double frame_time() const { return bvh_.frame_time; }

  // True if the joint has three rotation channels, which can express any rotation.
  static bool turns_freely(const BvhJoint& joint);
  // Rotations can be asked for and set where a joint turns freely.
  Eigen::Quaterniond rotation(int frame, const BvhJoint& joint) const;
  // Frames must come in ascending order. Among the angles that give this rotation,
  // takes those that continue the previous frame as the file's own angles do.
  void turn(int frame, const BvhJoint& joint, const Eigen::Quaterniond& rotation);

  std::string text() const;

 private:
  std::size_t place_of(int frame, std::size_t column) const {
    return static_cast<std::size_t>(frame) * bvh_.width + column;
  }

  std::string text_;
  BvhFile bvh_;
  std::map<std::size_t, double> changed_;  // degrees, by the number's place among all
};

}  // namespace spherechain::baker
