// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <set>

#include "motion/motion.h"

namespace spherechain::baker {
namespace {

Eigen::Quaterniond rotation_of(const Pose& pose, const std::string& joint) {
  const auto found = pose.rotations.find(joint);
  return found == pose.rotations.end() ? Eigen::Quaterniond::Identity() : found->second;
}

Pose half_way(const Pose& a, const Pose& b) {
  std::set<std::string> joints;
  for (const auto& [joint, rotation] : a.rotations) joints.insert(joint);
  for (const auto& [joint, rotation] : b.rotations) joints.insert(joint);
  Pose middle;
  for (const std::string& joint : joints)
    middle.rotations[joint] = rotation_of(a, joint).slerp(0.5, rotation_of(b, joint));
  return middle;
}

}  // namespace

BezierMotion::BezierMotion(const std::vector<Vec3>& rest, const std::vector<VertexWeights>& weights,
                           const std::vector<Joint>& joints, const BodyFrame& frame, const PoseMotion& motion)
    : keys_{rest} {
  Pose last;
  for (const Pose& next : motion.poses) {
    const std::vector<Vec3> from = keys_.back(), to = skin(rest, weights, joints, frame, next);
    // The control point that leads the curve through the pose half-way: a limb swings on an arc, its length nearly
    // stays.
    std::vector<Vec3> control = skin(rest, weights, joints, frame, half_way(last, next));
    for (std::size_t v = 0; v < rest.size(); ++v) control[v] = 2 * control[v] - 0.5 * (from[v] + to[v]);
    keys_.push_back(std::move(control));
    keys_.push_back(to);
    last = next;
  }
}

std::vector<Vec3> BezierMotion::at(double t) const {
  const std::size_t segments = keys_.size() / 2;
  if (segments == 0 || t <= 0) return keys_.front();
  if (t >= 1) return keys_.back();
  const double along = t * static_cast<double>(segments);
  const std::size_t segment = std::min(static_cast<std::size_t>(along), segments - 1);
  const double u = along - static_cast<double>(segment), a = (1 - u) * (1 - u), b = 2 * u * (1 - u), c = u * u;
  const auto *from = &keys_[2 * segment], *control = &keys_[2 * segment + 1], *to = &keys_[2 * segment + 2];
  std::vector<Vec3> positions(from->size());
  for (std::size_t v = 0; v < positions.size(); ++v) {
    positions[v] = a * (*from)[v] + b * (*control)[v] + c * (*to)[v];
  }
  return positions;
}

}  // namespace spherechain::baker
