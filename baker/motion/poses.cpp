// SPDX-License-Identifier: GPL-3.0-or-later
#include "motion/poses.h"

#include <algorithm>
#include <set>

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

using Bones = std::vector<Affine>;

Bones blend(double a, const Bones& x, double b, const Bones& y, double c, const Bones& z) {
  Bones out = x;
  for (std::size_t j = 0; j < out.size(); ++j) {
    out[j].matrix() = a * x[j].matrix() + b * y[j].matrix() + c * z[j].matrix();
  }
  return out;
}

}  // namespace

std::vector<Affine> bones_of(const std::vector<Joint>& joints, const BodyFrame& frame, const Pose& pose) {
  std::vector<Affine> out;
  for (const Joint& joint : joints) {
    Affine own = Affine::Identity();
    if (const auto found = pose.rotations.find(joint.name); found != pose.rotations.end()) {
      // The axis turns into the file's axes, the angle stays: no rotation stays exactly none.
      const Eigen::Quaterniond& q = found->second;
      const Vec3 axis = q.x() * frame.left + q.y() * frame.up + q.z() * frame.forward;
      own.linear() = Eigen::Quaterniond(q.w(), axis.x(), axis.y(), axis.z()).toRotationMatrix();
      own.translation() = joint.position - own.linear() * joint.position;
    }
    out.push_back(joint.parent < 0 ? own : out[static_cast<std::size_t>(joint.parent)] * own);
  }
  return out;
}

BezierMotion::BezierMotion(const std::vector<Joint>& joints, const BodyFrame& frame, const PoseMotion& motion)
    : keys_{bones_of(joints, frame, {})} {
  Pose last;
  for (const Pose& next : motion.poses) {
    const Bones from = keys_.back(), to = bones_of(joints, frame, next);
    // The control point that leads the curve through the pose half-way: a limb swings on an arc, its length nearly
    // stays.
    keys_.push_back(blend(-0.5, from, 2, bones_of(joints, frame, half_way(last, next)), -0.5, to));
    keys_.push_back(to);
    last = next;
  }
}

Deformation BezierMotion::at(double t) const {
  const std::size_t stretches = keys_.size() / 2;
  if (stretches == 0 || t <= 0) return {keys_.front(), {}, {}};
  if (t >= 1) return {keys_.back(), {}, {}};
  const double along = t * static_cast<double>(stretches);
  const std::size_t stretch = std::min(static_cast<std::size_t>(along), stretches - 1);
  const double u = along - static_cast<double>(stretch);
  const Bones* key = &keys_[2 * stretch];
  return {blend((1 - u) * (1 - u), key[0], 2 * u * (1 - u), key[1], u * u, key[2]), {}, {}};
}

}  // namespace spherechain::baker
