// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/bvh_text.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

namespace spherechain::baker {
namespace {

constexpr double kDegreesPerRadian = 180 / std::numbers::pi;

Eigen::Quaterniond about(int axis, double degrees) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(degrees / kDegreesPerRadian, Eigen::Vector3d::Unit(axis)));
}

// The same angle, as near to another as whole turns bring it.
double wound(double degrees, double near) { return degrees + 360 * std::round((near - degrees) / 360); }

// The angles of a joint: their axes, the outermost first, and their columns in a frame.
struct Angles {
  std::vector<int> axes;
  std::vector<std::size_t> columns;
};
Angles angles_of(const BvhJoint& joint) {
  Angles out;
  for (std::size_t c = 0; c < joint.channels.size(); ++c) {
    if (joint.channels[c].kind != BvhChannel::Kind::kRotation) continue;
    out.axes.push_back(joint.channels[c].axis);
    out.columns.push_back(joint.first_column + c);
  }
  return out;
}

}  // namespace

BvhText::BvhText(std::string text, const std::string& file)
    : text_(std::move(text)), bvh_(parse_bvh(text_, file, true)) {}

bool BvhText::turns_freely(const BvhJoint& joint) {
  const std::vector<int> axes = angles_of(joint).axes;
  return axes.size() == 3 && axes[0] != axes[1] && axes[1] != axes[2] && axes[0] != axes[2];
}

Eigen::Quaterniond BvhText::rotation(int frame, const BvhJoint& joint) const {
  Eigen::Quaterniond out = Eigen::Quaterniond::Identity();
  const Angles angles = angles_of(joint);
  for (std::size_t k = 0; k < angles.axes.size(); ++k) {
    out = out * about(angles.axes[k], bvh_.numbers[place_of(frame, angles.columns[k])]);
  }
  return out;
}

void BvhText::turn(int frame, const BvhJoint& joint, const Eigen::Quaterniond& rotation) {
  const auto [axes, columns] = angles_of(joint);
  Eigen::Vector3d near;
  for (std::size_t k = 0; k < 3; ++k) {
    near[static_cast<Eigen::Index>(k)] = bvh_.numbers[place_of(frame, columns[k])];
    if (frame == 0) continue;
    const std::size_t before = place_of(frame - 1, columns[k]);
    const auto changed = changed_.find(before);
    if (changed != changed_.end()) near[static_cast<Eigen::Index>(k)] += changed->second - bvh_.numbers[before];
  }
  const Eigen::Vector3d one = rotation.toRotationMatrix().eulerAngles(axes[0], axes[1], axes[2]) * kDegreesPerRadian;
  Eigen::Vector3d best;
  double least = HUGE_VAL;
  for (const Eigen::Vector3d& angles : {one, Eigen::Vector3d(one[0] + 180, 180 - one[1], one[2] + 180)}) {
    Eigen::Vector3d here;
    for (Eigen::Index k = 0; k < 3; ++k) here[k] = wound(angles[k], near[k]);
    if (const double apart = (here - near).norm(); apart < least) {
      least = apart;
      best = here;
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    changed_[place_of(frame, columns[k])] = best[static_cast<Eigen::Index>(k)];
  }
}

std::string BvhText::text() const {
  std::string out;
  std::size_t at = 0;
  const std::string stated = text_.substr(bvh_.count_begin, bvh_.count_end - bvh_.count_begin);
  if (const std::string count = std::to_string(frames()); stated != count) {
    out = text_.substr(0, bvh_.count_begin) + (stated.empty() ? "Frames: " + count + "\n" : count);
    at = bvh_.count_end;
  }
  for (const auto& [place, degrees] : changed_) {
    const std::size_t begin = bvh_.places[place];
    out.append(text_, at, begin - at);
    out += fmt::format("{:.6f}", degrees == 0 ? 0.0 : degrees);
    at = std::min(text_.find_first_of(" \t\r\n\v\f", begin), text_.size());
  }
  return out + text_.substr(at);
}

}  // namespace spherechain::baker
