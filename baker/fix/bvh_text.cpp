// SPDX-License-Identifier: GPL-3.0-or-later
#include "baker/fix/bvh_text.h"

#include <fmt/format.h>

#include "baker/mesh/euler.h"

namespace spherechain::baker {
namespace {

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
  const auto [axes, columns] = angles_of(joint);
  Eigen::Vector3d degrees;
  for (std::size_t k = 0; k < 3; ++k) degrees[static_cast<Eigen::Index>(k)] = bvh_.numbers[place_of(frame, columns[k])];
  return rotation_by({axes[0], axes[1], axes[2]}, degrees);
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
  const Eigen::Vector3d best = angles_near(rotation, {axes[0], axes[1], axes[2]}, near);
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
