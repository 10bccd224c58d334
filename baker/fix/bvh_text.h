// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <string>
#include <vector>

namespace spherechain::baker {

// The text of a BVH file, in which joints are turned: all else stays byte for byte.
class BvhText {
 public:
  struct Joint {
    std::string name;
    std::vector<int> axes;             // 0 x, 1 y, 2 z: of its angles, the outermost first
    std::vector<std::size_t> columns;  // of a frame's numbers
    // By three angles any rotation can be written.
    bool turns_freely() const {
      return axes.size() == 3 && axes[0] != axes[1] && axes[1] != axes[2] && axes[0] != axes[2];
    }
  };

  // `file` is for messages. Throws Error(kFile) where the text is no BVH, ends early, or two joints have one name.
  BvhText(std::string text, const std::string& file);

  const std::vector<Joint>& joints() const { return joints_; }
  int frames() const { return static_cast<int>(numbers_.size() / width_); }
  double frame_time() const { return frame_time_; }

  Eigen::Quaterniond rotation(int frame, const Joint& joint) const;
  // The joint must turn freely. Frames come in ascending order. Of the angles that are this rotation it takes those
  // that follow the frame before as the file's own do.
  void turn(int frame, const Joint& joint, const Eigen::Quaterniond& rotation);

  std::string text() const;

 private:
  struct Number {
    std::size_t at, size;  // in the text
    double value;
  };
  void read_joints(class BvhWords& words);
  const Number& number(int frame, std::size_t column) const {
    return numbers_[static_cast<std::size_t>(frame) * width_ + column];
  }

  std::string text_, file_;
  std::vector<Joint> joints_;
  std::size_t width_ = 0;  // numbers of a frame
  double frame_time_ = 0;
  std::vector<Number> numbers_;
  std::map<std::size_t, double> changed_;  // degrees, by the number's place among all
};

}  // namespace spherechain::baker
